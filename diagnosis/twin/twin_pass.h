#pragma once
// One pass of a twin over readings of its machine: the least squares of information.h on
// its innovations, averaged over blocks, about a theta0 that is given. Where the twin is
// true they are white, which makes the estimate the best there is. A pass begins
//
// - at rest: nothing of the start is unknown but what the numbers of the machine move;
// - in motion, with a gain that pulls the twin along: after it has forgotten, by the
//   stiffest gain and then by ever softer ones as a Kalman filter would, how it began;
// - in motion, with the gain of the force noise that is assumed: with its state among
//   the unknowns, about one that was measured, or that a twin had which has settled.

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "mjdiag/diagnosis/twin/drift.h"
#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/diagnosis/twin/kept_readings.h"
#include "mjdiag/diagnosis/twin/normalized_innovation.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/diagnosis/twin/whitened_block.h"

namespace mjdiag {

/// Where passes begin. Ticks from the first to the first that counts are whole blocks.
struct PassStart {
  Eigen::Index origin = 0;  ///< first tick that counts
  bool at_rest = true;
  /// Where a twin that is pulled along begins, to have settled at the origin: in a state
  /// that its machine had, nearly, whatever theta is.
  Eigen::Index settles_from = 0;
  TwinState settling;
  /// At the origin, if it is known: measured, or that of the last pass that has settled.
  bool known = false;
  TwinState state;

  /// To settle from there.
  void SettleFrom(Eigen::Index tick, const TwinState& near) noexcept {
    settles_from = tick;
    settling.x = near.x;
    settling.S.setZero();
    at_rest = known = false;
  }
  Eigen::Index first() const { return at_rest || known ? origin : settles_from; }
};

class TwinPass {
 public:
  /// @param tolerated  of its NIS
  explicit TwinPass(std::unique_ptr<Twin> twin, double tolerated = 1.0);

  const Twin& twin() const { return *twin_; }
  Twin& twin() { return *twin_; }
  std::size_t stiffest() const { return twin_->gains().size() - 1; }
  /// So many ticks or a few more, up to the end of a block.
  Eigen::Index WholeBlocks(Eigen::Index ticks) const {
    return (ticks + twin_->block() - 1) / twin_->block() * twin_->block();
  }

  // Nothing below allocates, locks or throws.

  /// In motion from that tick on, in the state that its readings say.
  void StartMeasured(const KeptReadings& run, Eigen::Index tick,
                     PassStart& start) noexcept;
  /// The same, settling from there first.
  void StartSettling(const KeptReadings& run, Eigen::Index tick,
                     PassStart& start) noexcept;
  /// Anew. What theta0 says of the start is left out of account where it is not unknown.
  /// @param start  gets the state of a twin that has settled
  /// @param prior  P0^-1, p x p
  /// @param nominal  p
  void Begin(PassStart& start, const Eigen::VectorXd& theta0, std::size_t gain,
             const Eigen::MatrixXd& prior, const Eigen::VectorXd& nominal) noexcept;
  /// The reading of the tick that it has come to. @return whether a block is added
  bool Step(const KeptReadings& run) noexcept;
  /// Where the estimate is too far from theta0: theta0 becomes theta, and the state goes
  /// with it to first order.
  void Shift() noexcept;
  /// What wears may have grown so far, and does not from now on: theta0 becomes what it is
  /// now.
  /// @param rate_sd  at which it may have [1/s]
  void TakeDrift(double rate_sd) noexcept;
  /// How much better what it has seen is explained if what wears has grown (Drift).
  double DriftGain(double rate_sd) noexcept;
  /// From now on with that gain.
  void Soften(std::size_t gain) noexcept;
  /// theta - theta0 if the errors that are left count as noise: far from the solution
  /// what is hardly known must not be bent to explain them. In place of the estimate.
  const Eigen::VectorXd& DiscountedChange() noexcept;

  bool began() const { return information_.active() > 0; }
  /// The next tick.
  Eigen::Index seen() const { return seen_; }
  Eigen::Index blocks() const { return blocks_; }
  /// Of these blocks.
  Eigen::Index ticks() const { return blocks_ * twin_->block(); }
  std::size_t gain() const { return gain_; }
  const Eigen::VectorXd& theta0() const { return theta0_; }
  const Eigen::VectorXd& theta() const { return theta_; }
  const Information& information() const { return information_; }
  Information& information() { return information_; }
  /// Whether what it says of growth is still to be taken, and that.
  bool drifts() const { return drifts_; }
  const Drift& drift() const { return drift_; }
  double drift_time() const { return twin_->drift_time(); }
  const NormalizedInnovation& normalized() const { return normalized_; }
  /// Of the tick before.
  const Eigen::VectorXd& innovation() const { return innovation_; }
  /// Mean square of the innovations so far over what was expected of them.
  double nis() const {
    return blocks_ > 0 ? squares_ / static_cast<double>(blocks_) : 1.0;
  }
  /// The largest of a block (NormalizedInnovation::Excess).
  double excess() const { return excess_; }

 private:
  void Settle() noexcept;
  void StartInState() noexcept;
  void Count(const Eigen::MatrixXd& psi) noexcept;

  std::unique_ptr<Twin> twin_;
  PassStart* start_ = nullptr;
  const Eigen::MatrixXd* prior_ = nullptr;
  std::size_t gain_ = 0;
  std::size_t pull_ = 0;        // gain now, gain_ when it has settled
  Eigen::Index softer_at_ = 0;  // tick of the next softer one
  bool settling_ = false;
  Eigen::Index seen_ = 0;
  Eigen::Index blocks_ = 0;
  double squares_ = 0.0;
  double excess_ = 0.0;
  Information information_;
  Drift drift_;
  bool drifts_ = false;
  NormalizedInnovation normalized_;
  Eigen::VectorXd theta0_, theta_, away_;
  WhitenedBlock block_;

  /// Innovation with which the twin is pulled: of a reading that comes at every n-th tick n
  /// times what it is, as S takes it that there is one at every tick. One that comes late,
  /// behind a gap, counts as those before it came.
  const Eigen::VectorXd& Pull(const KeptReadings& run) noexcept;

  Eigen::VectorXd reading_, innovation_, pull_by_;
  Eigen::VectorXd since_,
      spacing_;  // ticks since the last reading, and between the last
};

}  // namespace mjdiag
