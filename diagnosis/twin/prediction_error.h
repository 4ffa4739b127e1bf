#pragma once
// The recursive prediction error method [Ljung83] on a twin, in passes (twin_pass.h)
// about a theta0. Far from theta0 what a pass says is not exact, and it goes back:
//
// - It keeps the last readings. Where a block is surprising, or the estimate has moved
//   so far that the second order would be seen, a new pass begins at the first of them
//   from the better theta, and catches up with the machine at twice its pace. That is
//   the method of Gauss and Newton on a horizon that grows with what is explained; each
//   pass squares the error that is left.
// - Where the horizon does not grow, theta is too far for the twin to follow its machine
//   freely: a resonance has got out of step, a joint sticks at another time. Pulled
//   along, it makes short predictions that are nearly linear in theta. Passes over the
//   last readings begin with the stiffest gain and go on with ever softer ones, each
//   near enough to the solution of the next, down to the force noise that is assumed;
//   then over all readings.
// - What the data do not move is held at nominal by its prior; what is surely elsewhere
//   is not.
// - A machine that was explained for long and is not any more has changed: passes begin
//   anew at that tick.
//
// At the end of a run there is time to do the same over the whole of it.
//
// When the readings that it keeps do not reach back to the start, or say that what wears
// has grown since (drift.h), it follows: theta0
// moves with the estimate, the state with it to first order, and what wears walks at
// random, so that what was long ago is forgotten. Memory is constant, time unbounded.

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/checkpoints.h"
#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/run_start.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/diagnosis/twin/twin_pass.h"

namespace mjdiag {

struct PredictionErrorOptions {
  Eigen::Index kept = 32768;  ///< readings that it can go back to
  /// Random walk of what wears while it follows [1/sqrt(s)]. A fault that grows by 1 %
  /// an hour stays within its interval.
  double wear = 3e-5;
  /// How many times more surprising than by noise alone blocks of a healthy machine may
  /// be, 1 or more: its model is not exact.
  double tolerated = 1.0;
  /// Whether its model is the machine: else what is left is not noise, and tells of no
  /// growth.
  bool exact = true;
};

class PredictionErrorEstimator {
 public:
  /// @param unknowns  of the twin, p
  PredictionErrorEstimator(std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns,
                           double sample_time, const PredictionErrorOptions& options);
  PredictionErrorEstimator(const PredictionErrorEstimator&) = delete;
  PredictionErrorEstimator& operator=(const PredictionErrorEstimator&) = delete;

  /// One control tick. Does not allocate, lock, throw or do I/O.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept;
  /// At the end of a run: whatever passes it still takes.
  void CatchUp() noexcept;

  // What it says is what the pass said that has seen most: while it goes back, or is
  // pulled along, that stands. While it follows it says what it has at every block.

  /// Whether it has said anything yet.
  bool began() const { return said_.began; }
  /// theta, p.
  const Eigen::VectorXd& theta() const { return said_.theta; }
  /// H of what it has seen, prior and all, p x p.
  const Eigen::MatrixXd& H() const { return said_.information.H(); }
  /// Of it, what was there before any data, p x p.
  const Eigen::MatrixXd& prior() const { return said_.prior; }
  /// Unknowns that are estimated: all, or all but those of the start.
  Eigen::Index active() const { return said_.information.active(); }
  /// Variances of theta, p; of the start meaningless if it was at rest. Does not
  /// allocate.
  const Eigen::VectorXd& Variance() noexcept {
    return said_.variance = said_.information.Variance();
  }
  /// Those that Variance has found last; before that, of the prior.
  const Eigen::VectorXd& LastVariance() const { return said_.variance; }
  /// Mean over recent blocks of the squared innovations over what noise and the
  /// uncertainty of the estimate let expect of them, over what is tolerated: 1 where the
  /// twin explains them.
  double recent_nis() const { return said_.recent_nis; }
  /// Whether what it says is of the machine as it is now: it knows of no change since.
  bool current() const { return sure() && said_.since == segment_.since; }
  /// Whether the twin ran so near to it that the first order tells it, as its standard
  /// deviation takes for granted.
  bool sure() const { return said_.sure; }
  /// Whether it takes the machine as constant since then, and how that would change if it
  /// were not (drift.h), after DriftTime.
  bool constant() const { return said_.drifts && options_.exact; }
  const Drift& drift() const { return said_.drift; }
  double drift_time() const { return said_.drift_time; }
  const Information& information() const { return said_.information; }
  /// Tick from which the machine has been as it is estimated.
  Eigen::Index since() const { return said_.since; }
  /// Ticks that the estimate rests on.
  Eigen::Index horizon() const {
    return std::min(said_.until - said_.since, options_.kept);
  }
  int returns() const { return returns_; }
  /// Whether it follows: the readings that it keeps do not reach back any more, or the
  /// machine is not as it was at the first of them.
  bool following() const {
    return segment_.grows || kept_.added() - now().first() > options_.kept;
  }

 private:
  /// A stretch of the run in which the machine does not change.
  struct Segment {
    Eigen::Index since = 0;  ///< its first tick
    PassStart first;
    /// Of passes over the last readings, with a gain that pulls at first.
    PassStart window;
    bool windowed = false;  ///< passes begin there
    bool grows = false;     ///< what wears has grown in it
    /// Horizon in which that was seen, and not believed.
    Eigen::Index doubted = 0;
    int attempts = 0;            ///< of passes that are pulled along
    Eigen::Index explained = 0;  ///< longest horizon so far
    Eigen::Index surprised = 0;  ///< horizon of the last pass
    int stuck = 0;               ///< passes without a longer one
    int same = 0;                ///< passes that ended where the one before did
  };
  /// An estimate, with all that belongs to it.
  struct Estimate {
    bool began = false;
    bool sure = false;
    Information information;
    Drift drift;
    bool drifts = false;
    double drift_time = 0.0;  // [s]
    Eigen::VectorXd theta, variance;
    Eigen::MatrixXd prior;
    double recent_nis = 1.0;
    Eigen::Index since = 0;
    Eigen::Index until = 0;  ///< tick up to which it has seen
    std::size_t gain = 0;
  };

  const PassStart& now() const {
    return segment_.windowed ? segment_.window : segment_.first;
  }
  PassStart& now() { return segment_.windowed ? segment_.window : segment_.first; }
  std::size_t gain() const { return pass_.gain(); }
  bool CaughtUp() const { return pass_.seen() >= kept_.added(); }
  /// Follows it where it is now: a pass that is still on its way learns of what was constant
  /// until then.
  bool FollowsNow() const { return segment_.grows || (following() && CaughtUp()); }

  void FindStart() noexcept;
  /// The run did not begin at rest.
  void StartInMotion() noexcept;
  /// Another pass with that gain, about that theta.
  void Begin(std::size_t gain, const Eigen::VectorXd& theta) noexcept;
  /// theta0 of the next pass, from what this one says.
  const Eigen::VectorXd& NextTheta() noexcept;
  void WidenPrior() noexcept;
  void ProcessKept() noexcept;
  /// What this pass says is said, unless another has seen more or more finely.
  void Say() noexcept;
  /// What was said is not true: whatever comes takes its place.
  void Retract() noexcept;
  void Follow() noexcept;

  // What is decided at the end of a block (pass_policy.cc).
  void Reconsider() noexcept;
  void GoBack() noexcept;
  /// Passes anew from there, with that gain and about that theta.
  void StartOver(std::size_t gain, const Eigen::VectorXd& theta) noexcept;
  /// Pulled along: again, or more softly.
  void Approach() noexcept;
  void Unexplained() noexcept;
  void PullAlong() noexcept;
  bool TryChange() noexcept;
  /// Whether what this pass has seen is no chance on a machine that is constant.
  bool SeesGrowth() noexcept;
  /// Whether that is believed.
  bool IsGrowth(Eigen::Index horizon) const noexcept;
  /// The window becomes the last readings.
  void MoveWindow() noexcept;
  const Checkpoint* LastCheckpoint(Eigen::Index until) const noexcept;
  /// Of a segment whose first readings are not kept any more, the window is what is left.
  void ForgetLostStart() noexcept;
  /// From the first tick of the segment on, about next_.
  void WidenHorizon() noexcept;
  std::size_t Softer(std::size_t gain, Eigen::Index ticks) const noexcept;

  /// Passes that are pulled along with one gain.
  static constexpr int kPulledPasses = 6;
  /// Squared change, in standard deviations with one gain, that the next softer one can
  /// make good: its predictions are not much longer.
  static constexpr double kNear = 1000.0;

  // At the end of a run (whole_run.cc).
  void RunToTheEnd() noexcept;
  bool Explained() const noexcept;
  /// From nominal, pulled along at first.
  void ApproachWhole() noexcept;
  /// From where a number of the machine is orders of magnitude off.
  void ApproachFromFar() noexcept;
  /// Of this pass; infinite where it diverges.
  double Nis() const noexcept;
  /// Of a pass about that theta up to a tick.
  double NisOf(const Eigen::VectorXd& theta, Eigen::Index until) noexcept;
  /// far_ with one number of the machine orders of magnitude off, that which explains most
  /// of where it fails.
  void TryFarNumbers() noexcept;

  bool RejectsItsInnovations() const noexcept;
  double Farthest(const Eigen::VectorXd& change) const noexcept;
  /// What the first order does not tell of the change since theta0, in standard
  /// deviations.
  double Bias() const noexcept;
  /// Whether noise would show it.
  bool WorthGoingBack() const noexcept { return Bias() > 0.1; }

  TwinPass pass_;
  std::vector<Unknown> unknowns_;
  PredictionErrorOptions options_;
  Eigen::VectorXd nominal_;
  Eigen::MatrixXd prior_covariance_;
  Eigen::VectorXd walk_;  // of kWalkEvery ticks
  double constant_;       // gain of a drift that a machine without one may show

  KeptReadings kept_;
  RunStart run_start_;
  Segment segment_;
  bool looked_at_rest_ = false;  // when the run began
  /// That start, should it have been taken for one in motion since.
  PassStart at_rest_;
  Checkpoints checkpoints_;
  Eigen::Index next_look_;
  Eigen::Index look_ = 0;  // ticks of a pass that is pulled along
  int pulled_passes_ = 0;  // with this gain
  bool learned_ = false;   // nearly all there was, before this block
  int returns_ = 0;
  bool exhausted_ = false;  // of returns
  Eigen::MatrixXd prior_;
  Eigen::VectorXd variance_;
  Estimate said_;
  Eigen::VectorXd work_, next_, far_, nearest_;
  Eigen::MatrixXd inverse_;
};

}  // namespace mjdiag
