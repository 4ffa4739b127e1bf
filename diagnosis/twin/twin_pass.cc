#include "mjdiag/diagnosis/twin/twin_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// While the twin is pulled along, a block that is more surprising counts less, in
/// inverse proportion: a joint came loose a little sooner than the twin's.
constexpr double kRobust = 4.0;
/// Ticks in which a twin that had nearly the state of its machine has it again.
constexpr Index kResettle = 256;

}  // namespace

TwinPass::TwinPass(std::unique_ptr<Twin> twin, double tolerated)
    : twin_(std::move(twin)),
      information_(twin_->unknowns(), twin_->outputs()),
      drift_(twin_->unknowns(), twin_->drifting()),
      normalized_(twin_->outputs(), twin_->block(), tolerated),
      block_(twin_->outputs(), twin_->block(), twin_->unknowns(),
             static_cast<Index>(twin_->drifting().size())) {
  theta0_ = theta_ = away_ = VectorXd::Zero(twin_->unknowns());
  reading_ = innovation_ = VectorXd::Zero(twin_->outputs());
  pull_by_ = since_ = VectorXd::Zero(twin_->outputs());
  spacing_ = VectorXd::Ones(twin_->outputs());
}

void TwinPass::StartMeasured(const KeptReadings& run, Index tick,
                             PassStart& start) noexcept {
  start.at_rest = false;
  start.origin = start.settles_from = tick;
  reading_ = run.outputs(tick);
  for (Index i = 0; i < reading_.size(); ++i) {
    // Not measured: the next one that was.
    for (Index k = tick + 1; std::isnan(reading_[i]) && k < run.added(); ++k) {
      reading_[i] = run.outputs(k)[i];
    }
    if (std::isnan(reading_[i])) reading_[i] = 0.0;
  }
  twin_->StateAt(reading_, start.state);
  start.known = true;
}

void TwinPass::StartSettling(const KeptReadings& run, Index tick,
                             PassStart& start) noexcept {
  StartMeasured(run, tick, start);
  start.settling = start.state;
  start.origin += WholeBlocks(twin_->gains().back().settling);
  start.known = false;
}

void TwinPass::Begin(PassStart& start, const VectorXd& theta0, std::size_t gain,
                     const MatrixXd& prior, const VectorXd& nominal) noexcept {
  start_ = &start;
  prior_ = &prior;
  drifts_ = !drift_.drifting().empty();
  twin_->UseDrift(drifts_);
  drift_.Start();
  gain_ = pull_ = gain;
  theta0_ = theta0;
  settling_ = false;
  const bool with_start = !start.at_rest && gain == 0;
  const Index started = twin_->start_unknowns();
  if (!with_start || !start.known) theta0_.tail(started).setZero();
  if (start.at_rest) {
    twin_->UseGain(gain);
    twin_->Start(theta0_);
    seen_ = start.origin;
  } else if (start.known && with_start) {
    StartInState();
  } else {
    settling_ = true;
    pull_ = stiffest();
    twin_->UseGain(pull_);
    twin_->Start(theta0_, start.settling, start.settles_from);
    seen_ = start.settles_from;
  }
  theta_ = theta0_;
  away_ = nominal - theta0_;
  information_.Start(twin_->unknowns() - (with_start ? 0 : started), prior, away_);
  normalized_.Start();
  softer_at_ = start.origin;
  block_.Start();
  since_.setZero();
  spacing_.setOnes();
  blocks_ = 0;
  squares_ = excess_ = 0.0;
}

void TwinPass::StartInState() noexcept {
  twin_->UseGain(0);
  twin_->Start(theta0_, start_->state, start_->origin);
  seen_ = start_->origin;
}

bool TwinPass::Step(const KeptReadings& run) noexcept {
  twin_->Predict(reading_);
  innovation_ = run.outputs(seen_) - reading_;
  twin_->Step(run.inputs(seen_), Pull(run));
  block_.Add(innovation_, run.outputs(seen_));
  ++seen_;
  if (!block_.full()) return false;
  const MatrixXd& psi = twin_->EndBlock();
  const bool counts = !settling_;
  if (counts && block_.any()) Count(psi);
  block_.Start();
  if (settling_ && seen_ == start_->origin - kResettle) {
    // From here the next pass is there sooner.
    twin_->ReadState(start_->state);
    start_->SettleFrom(seen_, start_->state);
  }
  if (settling_ && seen_ >= start_->origin) Settle();
  if (!settling_ && pull_ > gain_ && seen_ >= softer_at_) {
    twin_->UseGain(--pull_);
    softer_at_ = seen_ + twin_->gains()[pull_].settling;
  }
  return counts;
}

const VectorXd& TwinPass::Pull(const KeptReadings& run) noexcept {
  for (Index i = 0; i < innovation_.size(); ++i) {
    since_[i] += 1.0;
    if (std::isnan(run.outputs(seen_)[i])) {
      innovation_[i] = pull_by_[i] = 0.0;
      continue;
    }
    pull_by_[i] = std::min(since_[i], spacing_[i]) * innovation_[i];
    spacing_[i] = since_[i];
    since_[i] = 0.0;
  }
  return pull_by_;
}

void TwinPass::Settle() noexcept {
  settling_ = false;
  twin_->ReadState(start_->state);
  start_->known = true;
  if (gain_ > 0) return;
  pull_ = 0;
  StartInState();
}

void TwinPass::Count(const MatrixXd& psi) noexcept {
  block_.Whiten(psi, information_.active(), drifts_ ? &twin_->drift() : nullptr,
                twin_->gains()[pull_].covariance);
  const double squares =
      information_.NormalizedInnovation(block_.slow_psi(), block_.slow_e());
  ++blocks_;
  squares_ += squares;
  normalized_.Add(squares);
  excess_ = std::max(excess_, normalized_.Excess());
  if (gain_ > 0 && squares > kRobust) block_.Discount(squares / kRobust);
  information_.Add(block_.psi(), block_.e());
  if (drifts_) {
    drift_.Add(block_.psi(), block_.rates(), block_.e(), information_.active());
  }
  theta_ = theta0_ + information_.change();
}

void TwinPass::Shift() noexcept {
  theta0_ += information_.change();
  theta_ = theta0_;
  twin_->Shift(information_.change());
  information_.Recentre();
}

double TwinPass::DriftGain(double rate_sd) noexcept {
  if (!drifts_) return 0.0;
  drift_.Solve(information_, twin_->drift_time(), rate_sd);
  return drift_.gain();
}

void TwinPass::TakeDrift(double rate_sd) noexcept {
  if (!drifts_) return;
  drift_.Solve(information_, twin_->drift_time(), rate_sd);
  // First to where the estimate was at the start, then on with what has grown.
  away_ = information_.change() + drift_.change();
  for (std::size_t i = 0; i < drift_.drifting().size(); ++i) {
    away_[drift_.drifting()[i]] -=
        twin_->drift_time() * drift_.rates()[static_cast<Index>(i)];
  }
  twin_->Shift(away_);
  twin_->Drifted(drift_.rates());
  theta0_ += information_.change() + drift_.change();
  theta_ = theta0_;
  information_.Assume(drift_.information());
  drifts_ = false;
  twin_->UseDrift(false);
}

void TwinPass::Soften(std::size_t gain) noexcept {
  gain_ = pull_ = gain;
  twin_->UseGain(gain);
}

const VectorXd& TwinPass::DiscountedChange() noexcept {
  information_.Discount(*prior_, away_, std::max(1.0, nis()));
  return information_.change();
}

}  // namespace mjdiag
