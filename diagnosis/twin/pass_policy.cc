// When a pass is worth another one, where that begins and how softly it is pulled.

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/twin/prediction_error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Passes without a longer horizon before the twin is pulled along.
constexpr int kPatience = 3;
/// A machine that this many passes do not explain is another one.
constexpr int kMostReturns = 150;
/// A machine explained for that long has changed if it is not any more, which as many
/// passes have to confirm.
constexpr Index kLongExplained = 1024;
constexpr Index kSame = 64;  // ticks
constexpr int kConfirmed = 1;
/// A change shows within so many ticks.
constexpr Index kUnnoticed = 256;
/// Ticks before the surprise in which the change was there already.
constexpr Index kNoticed = 16;
/// Ticks between two looks for growth.
constexpr Index kGrowthEvery = 512;
/// What is not explained for that long from the first tick on was not at rest there.
constexpr Index kAtOnce = 64;

/// Ticks that a twin looks at that is pulled along, and of the first guess of one that
/// began at rest.
constexpr Index kLook = 1024;
constexpr Index kFirstGuess = 128;
/// Standard deviations of what the first order does not tell.
constexpr double kTooFar = 3.0;

}  // namespace

void PredictionErrorEstimator::StartInMotion() noexcept {
  Retract();
  if (pass_.twin().linear()) {
    pass_.StartMeasured(kept_, 0, segment_.first);
    return StartOver(0, nominal_);
  }
  pass_.StartSettling(kept_, 0, segment_.first);
  segment_.window = segment_.first;
  segment_.windowed = true;
  StartOver(pass_.stiffest(), nominal_);
}

void PredictionErrorEstimator::StartOver(std::size_t gain,
                                         const VectorXd& theta) noexcept {
  segment_.explained = segment_.surprised = 0;
  segment_.grows = false;
  segment_.doubted = 0;
  segment_.stuck = segment_.same = 0;
  pulled_passes_ = 0;
  look_ = segment_.windowed && segment_.window.at_rest ? kFirstGuess : kLook;
  next_look_ = kept_.added() + kLook;
  next_ = theta;
  next_.tail(pass_.twin().start_unknowns()).setZero();
  WidenPrior();
  Begin(gain, next_);
}

void PredictionErrorEstimator::GoBack() noexcept { Begin(gain(), NextTheta()); }

void PredictionErrorEstimator::Reconsider() noexcept {
  if (RejectsItsInnovations()) return Unexplained();
  if (segment_.windowed) return Approach();
  const Index horizon = pass_.seen() - now().origin;
  if (gain() == 0 && pass_.ticks() % kGrowthEvery == 0) {
    if (!SeesGrowth()) {
      if (horizon >= segment_.doubted) segment_.doubted = 0;
    } else if (IsGrowth(horizon)) {
      segment_.grows = true;
      return Follow();
    } else if (segment_.doubted == 0) {
      segment_.doubted = horizon;
      if (WorthGoingBack()) return GoBack();
    }
  }
  if (Bias() > kTooFar && 4 * horizon > 5 * segment_.explained) {
    segment_.explained = horizon;
    return GoBack();
  }
  if (!CaughtUp() || pass_.seen() < next_look_) return;
  next_look_ = kept_.added() + horizon / 2;
  if (WorthGoingBack()) GoBack();
}

bool PredictionErrorEstimator::IsGrowth(Index horizon) const noexcept {
  // What the plant's curvature leaves about a theta that is far off, or a joint that came
  // loose at another tick, may look like growth for a while: it has to be seen again about a
  // better theta, in twice the time.
  return pass_.twin().linear() ||
         (segment_.doubted > 0 && horizon >= 2 * segment_.doubted);
}

void PredictionErrorEstimator::Approach() noexcept {
  if (pass_.ticks() < look_) return;
  if (look_ < kLook) {
    look_ *= 2;
    if (WorthGoingBack()) GoBack();
    return;
  }
  const bool near =
      gain() == 0 ? !WorthGoingBack() : pass_.information().SquaredChange() < kNear;
  const bool again = !near && ++pulled_passes_ < kPulledPasses;
  const VectorXd& theta = NextTheta();
  if (!again && gain() == 0) return WidenHorizon();
  MoveWindow();
  if (again) return Begin(gain(), theta);
  pulled_passes_ = 0;
  Begin(Softer(gain(), kLook), theta);
}

std::size_t PredictionErrorEstimator::Softer(std::size_t gain,
                                             Index ticks) const noexcept {
  if (gain == 0) return 0;
  // One that a pass does not come to in that time is as good as none.
  Index until = 0;
  for (std::size_t i = gain; i < pass_.stiffest(); ++i) {
    until += pass_.twin().gains()[i].settling;
  }
  return until > ticks ? 0 : gain - 1;
}

const Checkpoint* PredictionErrorEstimator::LastCheckpoint(Index until) const noexcept {
  return checkpoints_.Last(std::max(now().origin, kept_.first() + 1), until);
}

void PredictionErrorEstimator::MoveWindow() noexcept {
  if (!CaughtUp()) return;
  const Checkpoint* from = LastCheckpoint(pass_.seen() - kLook - kUnnoticed);
  if (from == nullptr) return;
  PassStart& window = segment_.window;
  window.SettleFrom(from->tick, from->state);
  window.origin = from->tick + kUnnoticed;
}

void PredictionErrorEstimator::ForgetLostStart() noexcept {
  if (segment_.first.first() < kept_.first()) segment_.first = segment_.window;
}

void PredictionErrorEstimator::WidenHorizon() noexcept {
  ForgetLostStart();
  segment_.windowed = false;
  segment_.explained = pulled_passes_ = 0;
  next_look_ = 0;
  next_.tail(pass_.twin().start_unknowns()).setZero();
  Begin(0, next_);
}

void PredictionErrorEstimator::Unexplained() noexcept {
  // Beside a machine that it had nothing to learn of any more.
  if (learned_ && TryChange()) return;
  const Index horizon = pass_.seen() - now().origin;
  const bool same = std::abs(horizon - segment_.surprised) <= kSame;
  segment_.same = same ? segment_.same + 1 : 0;
  segment_.surprised = horizon;
  if (4 * horizon > 5 * segment_.explained) {
    segment_.explained = horizon;
    segment_.stuck = 0;
  } else {
    ++segment_.stuck;
    if (segment_.same >= kConfirmed && TryChange()) return;
    if (segment_.stuck > kPatience) return PullAlong();
  }
  exhausted_ = returns_ >= kMostReturns;
  if (!exhausted_) GoBack();
}

void PredictionErrorEstimator::PullAlong() noexcept {
  const PassStart& first = segment_.first;
  const bool again = segment_.attempts++ > 0;
  if (!again && first.at_rest && segment_.explained < kAtOnce) return StartInMotion();
  Retract();
  exhausted_ = returns_ >= kMostReturns;
  if (exhausted_) return;
  // States of a twin that does not explain the machine are of no use.
  checkpoints_.Clear();
  segment_.windowed = true;
  if (first.at_rest && !again) {
    segment_.window = first;
  } else {
    // Where the first attempt was in vain, other readings may tell more.
    const Index last = kept_.added() - kLook - pass_.twin().gains().back().settling;
    pass_.StartSettling(kept_, std::max({last, first.first(), kept_.first()}),
                        segment_.window);
  }
  StartOver(pass_.stiffest(), nominal_);
}

bool PredictionErrorEstimator::TryChange() noexcept {
  if (gain() > 0 && !following()) return false;
  // Early in a run a change is harder to tell from a bad theta: all else is tried first,
  // and it is taken for one once, or what nothing explains would be cut into pieces.
  const bool nothing_else = segment_.attempts > 0 && segment_.since == 0;
  if (pass_.seen() - now().origin < kLongExplained && !nothing_else) return false;
  const Checkpoint* from = LastCheckpoint(pass_.seen() - kUnnoticed);
  if (from == nullptr) return false;
  PassStart& first = segment_.first;
  segment_.since = pass_.seen() - kNoticed;
  segment_.windowed = !pass_.twin().linear();
  segment_.attempts = 0;
  if (pass_.twin().linear()) {
    pass_.StartMeasured(kept_, segment_.since, first);
  } else {
    // Until the change it was another machine: half of the forgetting, for its state was
    // known there.
    first.SettleFrom(from->tick, from->state);
    first.origin =
        segment_.since + pass_.WholeBlocks(pass_.twin().gains().back().settling / 2);
    segment_.window = first;
  }
  returns_ = 0;
  variance_ = pass_.information().Variance();
  StartOver(segment_.windowed ? pass_.stiffest() : 0, pass_.theta());
  return true;
}

}  // namespace mjdiag
