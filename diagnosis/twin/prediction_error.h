#pragma once
// The recursive prediction error method [Ljung83] on a twin: the least squares of
// information.h on its innovations, averaged over blocks. They are white where the twin
// is true, which makes the estimate the best there is. Far from the point theta0 at
// which the twin runs that is not exact, and it goes back:
//
// - It keeps the last readings. Where a block is surprising, or the estimate has moved
//   so far that the second order would be seen, it starts anew at the first of them from
//   the better theta, and catches up with the machine at twice its pace. That is the
//   method of Gauss and Newton on a horizon that grows with what is explained; each
//   pass squares the error that is left.
// - Where the horizon does not grow any more, the machine is looked at more coarsely: a
//   course of sticking and slipping that is told to the last digit can be told in one
//   way only. The twin is pulled along by its stiffest gain, which makes predictions
//   short and nearly linear, on the last readings only; from the theta that it finds
//   they are then told as finely as can be, first the last ones, then all. Where that
//   does not succeed, a gain between the two may.
// - What the data do not move is held at nominal by its prior; what is surely elsewhere
//   is not.
// - A machine that was explained for long and is not any more has changed: it starts
//   anew at that tick, pulled along from the state that the twin had shortly before.
//
// A run that does not begin at rest begins with its first reading: in a state that is
// among the unknowns, or pulled along by the stiffest gain until it has forgotten it.
//
// When the readings that it keeps do not reach back to the start, it follows: theta0
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
#include "mjdiag/diagnosis/twin/surprise.h"
#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

struct PredictionErrorOptions {
  Eigen::Index kept = 32768;  ///< readings that it can go back to
  /// Random walk of what wears while it follows [1/sqrt(s)]. A fault that grows by 1 %
  /// an hour stays within its interval.
  double wear = 3e-5;
};

class PredictionErrorEstimator {
 public:
  /// @param unknowns  of the twin, p
  PredictionErrorEstimator(std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns,
                           double sample_time, const PredictionErrorOptions& options);

  /// One control tick. Does not allocate, lock, throw or do I/O.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept;
  /// At the end of a run: whatever readings it has yet to catch up with.
  void CatchUp() noexcept;

  // What it says is what the pass said that has seen most: while it goes back, or looks
  // more coarsely, that stands.

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
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  /// Mean over recent blocks of the squared innovations over what noise and the
  /// uncertainty of the estimate let expect of them: 1 where the twin explains them.
  double surprise() const { return said_.surprise; }
  /// Whether what it says is of the machine as it is now: it knows of no change since.
  bool current() const { return sure() && said_.since == segment_.first.origin; }
  /// Whether the twin ran so near to it that the first order tells it, as its standard
  /// deviation takes for granted.
  bool sure() const { return said_.sure; }
  /// Tick at which the phases of its tones begin.
  Eigen::Index phase_origin() const { return said_.phase_origin; }
  /// Tick from which the machine has been as it is estimated.
  Eigen::Index since() const { return said_.since; }
  int returns() const { return returns_; }

 private:
  /// Ticks of a first guess with the stiffest gain.
  static constexpr Eigen::Index kFirstGuess = 128;
  /// Blocks between two steps of the walk, and of theta0, while it follows.
  static constexpr Eigen::Index kWalkEvery = 64;

  /// Where passes begin.
  struct Beginning {
    Eigen::Index origin = 0;  ///< first tick that counts
    bool at_rest = true;
    Eigen::VectorXd state;  ///< there, of the twin
    /// Where a twin that is pulled along begins, and in how many ticks it settles.
    Eigen::Index settling_from = 0;
    Eigen::Index settling = 0;
    Eigen::VectorXd settling_state;
  };
  /// A stretch of the run in which the machine does not change.
  struct Segment {
    Beginning first;
    Beginning now;               ///< of passes that do not go back to the first
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
    Eigen::VectorXd theta, variance;
    Eigen::MatrixXd prior;
    double surprise = 1.0;
    Eigen::Index phase_origin = 0;
    Eigen::Index since = 0;
    Eigen::Index until = 0;  ///< tick up to which it has seen
    std::size_t gain = 0;
  };

  bool FindStart() noexcept;
  /// The run did not begin at rest.
  void StartInMotion() noexcept;
  /// One tick of the twin on kept readings. @return whether it ends a block
  bool StepTwin() noexcept;

  void Begin() noexcept;
  /// What this pass says is said, unless another has seen more or more finely.
  void Say() noexcept;
  /// What was said is not true: whatever comes takes its place.
  void Retract() noexcept;
  void GoBack() noexcept;
  void WidenPrior() noexcept;
  void ProcessKept() noexcept;
  void Regress() noexcept;
  void Reconsider() noexcept;
  /// With the stiffest gain: passes over ever more readings, as many as a guess takes.
  void Guess() noexcept;
  void Unexplained() noexcept;
  /// The softest gain with which it can tell the machine: none if where it started is
  /// known or among the unknowns, else one that forgets it.
  std::size_t Finest() const noexcept;
  bool Pulled() const noexcept { return gain_ > Finest() && !following(); }
  /// Whether passes begin with the stiffest gain, which forgets how the twin began, and
  /// go on with softer ones as a Kalman filter would.
  bool Settles() const noexcept { return gain_ > 0 && !following(); }
  bool Surprised() const noexcept;
  /// Passes anew from there, with that gain and about that theta.
  void StartOver(std::size_t gain, const Eigen::VectorXd& theta) noexcept;
  /// Only the last readings matter for a first guess: so many of them.
  void MoveOrigin() noexcept;
  /// From the first tick of the segment on, if it is still kept.
  bool WidenHorizon() noexcept;
  const Checkpoint* LastCheckpoint(Eigen::Index until) const noexcept {
    return checkpoints_.Last(std::max(segment_.now.origin, kept_.first() + 1), until);
  }
  /// Passes do not get farther: more coarsely.
  void LookMoreCoarsely() noexcept;
  /// All so far is explained: more finely, if it is not looked at as finely as can be.
  bool LookMoreFinely() noexcept;
  bool TryChange() noexcept;
  void Follow() noexcept;
  void PassesToTheEnd() noexcept;
  bool following() const { return kept_.added() - segment_.now.origin > options_.kept; }
  double Farthest(const Eigen::VectorXd& change) const noexcept;
  /// What the first order leaves of the change since theta0, in standard deviations, for
  /// a curvature of 1.
  double SecondOrder() const noexcept;
  /// Whether noise would show it.
  bool WorthGoingBack() const noexcept;

  std::unique_ptr<Twin> twin_;
  std::vector<Unknown> unknowns_;
  double sample_time_;
  PredictionErrorOptions options_;
  Eigen::VectorXd nominal_;
  Eigen::MatrixXd prior_covariance_;
  Eigen::VectorXd walk_;                      // of kWalkEvery blocks
  std::vector<Eigen::MatrixXd> covariances_;  // of a block's innovation, by gain

  KeptReadings kept_;
  Eigen::Index seen_ = 0;
  Eigen::Index next_look_;
  Eigen::Index look_;     // ticks of a guess
  bool learned_ = false;  // all there was, before this block
  int returns_ = 0;
  bool exhausted_ = false;  // of returns
  int pulled_passes_ = 0;   // with this gain
  bool settled_ = false;
  Eigen::Index counts_from_ = 0;  // of this pass
  std::size_t pull_ = 0;          // gain of the twin now, gain_ when it has settled
  Eigen::Index softer_at_ = 0;    // tick of the next softer one
  Eigen::Index phase_origin_ = 0;

  Segment segment_;
  Checkpoints checkpoints_;
  std::size_t gain_ = 0;
  std::vector<Eigen::VectorXd> proven_;  // theta that explained all, by gain
  std::vector<bool> is_proven_;
  RunStart run_start_;
  Information information_;
  Eigen::MatrixXd prior_;
  Eigen::VectorXd center_;  // theta0
  Eigen::VectorXd theta_;
  Eigen::VectorXd variance_;
  Surprise surprise_;
  Estimate said_;
  Eigen::Index blocks_ = 0;  // of this pass
  Eigen::Index in_block_ = 0;
  Eigen::VectorXd reading_, innovation_, sum_, work_;
  Eigen::MatrixXd inverse_, covariance_;
};

}  // namespace mjdiag
