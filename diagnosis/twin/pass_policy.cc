// When a pass is worth another one, where it begins and how finely it looks.

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/twin/prediction_error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A change by less than that, in standard deviations that an unknown has where all
/// others are known, needs no other pass.
constexpr double kMoved = 0.3;
/// Nor does one of which the second order is less than that.
constexpr double kCurved = 0.1;
/// Passes without a longer horizon before it is looked at more coarsely.
constexpr int kPatience = 3;
/// A machine that this many passes do not explain is another one.
constexpr int kMostReturns = 150;
/// At the end of a run, until the estimate is where the twin runs.
constexpr int kLastPasses = 12;
/// A machine explained for that long has changed if it is not any more, which as many
/// passes have to confirm.
constexpr Index kLongExplained = 1024;
constexpr Index kSame = 64;  // ticks
constexpr int kConfirmed = 1;
/// A change shows within so many ticks.
constexpr Index kUnnoticed = 256;
/// Blocks before the surprise in which the change was there already.
constexpr Index kNoticed = 2;
/// What is not explained for that long from the first tick on was not at rest there.
constexpr Index kAtOnce = 64;
/// On average over recent blocks, that is none that came loose.
constexpr double kSurprisingThroughout = 8.0;
/// Ticks that a twin looks at that is pulled along, before it goes back.
constexpr Index kPulledLook = 1024;
constexpr int kPulledPasses = 6;

}  // namespace

void PredictionErrorEstimator::Reconsider() noexcept {
  if (!Pulled() && Surprised()) return Unexplained();
  if (Pulled() && gain_ + 1 == covariances_.size()) return Guess();
  if (seen_ < kept_.added() || seen_ < next_look_) return;
  next_look_ = kept_.added() +
               (Pulled() ? kPulledLook : (kept_.added() - segment_.now.origin) / 2);
  if (Pulled()) {
    if (!WorthGoingBack() || ++pulled_passes_ > kPulledPasses) {
      LookMoreFinely();
    } else {
      GoBack();
    }
  } else if (!WidenHorizon() && WorthGoingBack()) {
    GoBack();
  }
}

void PredictionErrorEstimator::Guess() noexcept {
  if (seen_ - counts_from_ < look_) return;
  const bool worth = WorthGoingBack() && pulled_passes_ < kPulledPasses;
  if (look_ >= kPulledLook && !worth) {
    LookMoreFinely();
    return;
  }
  if (look_ < kPulledLook) {
    look_ *= 2;
  } else {
    ++pulled_passes_;
    MoveOrigin();
  }
  if (worth) GoBack();
}

void PredictionErrorEstimator::MoveOrigin() noexcept {
  if (seen_ < kept_.added()) return;
  const Checkpoint* from = LastCheckpoint(seen_ - kPulledLook - kUnnoticed);
  if (from == nullptr) return;
  Beginning& now = segment_.now;
  now.at_rest = false;
  now.settling_from = from->tick;
  now.settling = kUnnoticed;
  now.settling_state = from->state;
  now.origin = from->tick + kUnnoticed;
}

bool PredictionErrorEstimator::WidenHorizon() noexcept {
  const Beginning& first = segment_.first;
  if (segment_.now.origin == first.origin ||
      std::min(first.origin, first.settling_from) < kept_.first()) {
    return false;
  }
  segment_.now = first;
  next_look_ = kept_.added() + (kept_.added() - first.origin) / 2;
  GoBack();
  return true;
}

void PredictionErrorEstimator::Unexplained() noexcept {
  // Beside a machine that it had nothing to learn of any more.
  if (learned_ && TryChange()) return;
  const Index horizon = seen_ - segment_.now.origin;
  const bool same = std::abs(horizon - segment_.surprised) <= kSame;
  segment_.same = same ? segment_.same + 1 : 0;
  segment_.surprised = horizon;
  if (4 * horizon > 5 * segment_.explained) {
    segment_.explained = horizon;
    segment_.stuck = 0;
  } else {
    ++segment_.stuck;
    if (segment_.same >= kConfirmed && TryChange()) return;
    if (segment_.stuck > kPatience) return LookMoreCoarsely();
  }
  exhausted_ = returns_ >= kMostReturns;
  if (!exhausted_) GoBack();
}

void PredictionErrorEstimator::LookMoreCoarsely() noexcept {
  if (segment_.first.at_rest && segment_.explained < kAtOnce) return StartInMotion();
  Retract();
  const std::size_t stiffest = covariances_.size() - 1;
  exhausted_ = gain_ == stiffest || returns_ >= kMostReturns ||
               (gain_ + 1 == stiffest && is_proven_[stiffest]);
  if (exhausted_) return;
  if (is_proven_[stiffest]) return StartOver(gain_ + 1, proven_[stiffest]);
  // States of a twin that does not explain the machine are of no use.
  checkpoints_.Clear();
  StartOver(stiffest, nominal_);
}

bool PredictionErrorEstimator::LookMoreFinely() noexcept {
  if (gain_ == Finest()) return false;
  proven_[gain_] = theta_;
  is_proven_[gain_] = true;
  const std::size_t stiffest = covariances_.size() - 1;
  StartOver(gain_ == stiffest ? Finest() : gain_ - 1, theta_);
  return true;
}

bool PredictionErrorEstimator::TryChange() noexcept {
  if (Pulled() || seen_ - counts_from_ < kLongExplained) return false;
  const Checkpoint* from = LastCheckpoint(seen_ - kUnnoticed);
  if (from == nullptr) return false;
  Beginning& first = segment_.first;
  first.at_rest = false;
  first.settling_from = from->tick;
  first.settling = kUnnoticed;
  first.settling_state = first.state = from->state;
  first.origin = seen_ - kNoticed * twin_->block();
  if (twin_->start_unknowns() > 0) {
    // Any state will do where it is among the unknowns.
    reading_ = kept_.outputs(first.origin);
    twin_->StateAt(reading_, first.state);
  }
  segment_.now = first;
  returns_ = 0;
  std::fill(is_proven_.begin(), is_proven_.end(), false);
  variance_ = information_.Variance();
  StartOver(twin_->start_unknowns() > 0 ? 0 : covariances_.size() - 1, theta_);
  return true;
}

std::size_t PredictionErrorEstimator::Finest() const noexcept {
  const bool known = segment_.now.at_rest || twin_->start_unknowns() > 0;
  return known ? 0 : std::min<std::size_t>(1, covariances_.size() - 1);
}

void PredictionErrorEstimator::Follow() noexcept {
  if (Surprised()) {
    // The readings that it keeps begin after the origin, so only a change remains.
    exhausted_ = false;
    if (TryChange()) return;
  }
  if (blocks_ % kWalkEvery != 0) return;
  information_.Walk(walk_);
  const std::size_t soft = std::min<std::size_t>(1, covariances_.size() - 1);
  if (gain_ < soft) {
    gain_ = pull_ = soft;
    twin_->UseGain(pull_);
  }
  center_ += information_.change();
  theta_ = center_;
  twin_->Shift(information_.change());
  information_.Recentre();
}

void PredictionErrorEstimator::PassesToTheEnd() noexcept {
  while (seen_ < kept_.added()) ProcessKept();
  std::size_t failed = covariances_.size();  // gain
  for (int i = 0; i < kMostReturns && !following() && !exhausted_; ++i) {
    if (WorthGoingBack() && ++pulled_passes_ <= kLastPasses) {
      GoBack();
    } else if (gain_ != Finest() && gain_ != failed + 1) {
      LookMoreFinely();
    } else if (!WidenHorizon()) {
      break;
    }
    const std::size_t tried = gain_;
    while (seen_ < kept_.added()) ProcessKept();
    if (gain_ > tried) {
      failed = tried;
      pulled_passes_ = 0;
    }
  }
}

void PredictionErrorEstimator::CatchUp() noexcept {
  if (information_.active() > 0) PassesToTheEnd();
}

double PredictionErrorEstimator::Farthest(const VectorXd& change) const noexcept {
  double farthest = 0.0;
  for (Index i = 0; i < change.size(); ++i) {
    const double reach = unknowns_[static_cast<std::size_t>(i)].reach;
    farthest = std::max(farthest, reach * std::abs(change[i]));
  }
  return farthest;
}

double PredictionErrorEstimator::SecondOrder() const noexcept {
  // Of the machine: where it started may be hard to say and does not matter.
  const Index machine = theta_.size() - twin_->start_unknowns();
  const VectorXd& change = information_.change();
  double moved = 0.0;
  for (Index i = 0; i < machine; ++i) {
    moved = std::max(moved, change[i] * change[i] * information_.H()(i, i));
  }
  return moved > kMoved * kMoved ? std::sqrt(moved) * Farthest(change) : 0.0;
}

bool PredictionErrorEstimator::WorthGoingBack() const noexcept {
  return twin_->curvature() * SecondOrder() > kCurved;
}

void PredictionErrorEstimator::StartOver(std::size_t gain,
                                         const VectorXd& theta) noexcept {
  gain_ = gain;
  segment_.explained = segment_.surprised = 0;
  segment_.stuck = segment_.same = 0;
  pulled_passes_ = 0;
  next_look_ = kept_.added() + kPulledLook;
  look_ = kPulledLook;
  center_ = theta_ = theta;
  information_.Recentre();
  GoBack();
}

bool PredictionErrorEstimator::Surprised() const noexcept {
  return gain_ > 0 ? !(surprise_.recent() < kSurprisingThroughout)
                   : surprise_.NoChance();
}

}  // namespace mjdiag
