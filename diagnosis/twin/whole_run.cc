// The end of a run: there is time for passes over the whole of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/diagnosis/twin/prediction_error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// At the end of a run, until the estimate is where the twin runs.
constexpr int kLastPasses = 12;
/// Squared change that no other pass is needed after, in standard deviations.
constexpr double kThere = 0.1;
/// Of a number of the machine, that passes begin from.
constexpr std::array kFarFactors = {1e-3, 1e-2, 0.1, 10.0, 1e2, 1e3};
/// Ticks in which it shows whether one is better.
constexpr Index kFarLook = 4096;
/// Of the NIS, that another pass has to leave for the next one to be worth its time: near
/// an explanation each squares the error that is left.
constexpr double kWorthwhile = 0.9;
/// Numbers that are that far off together.
constexpr int kFarNumbers = 3;

}  // namespace

void PredictionErrorEstimator::RunToTheEnd() noexcept {
  while (!CaughtUp()) pass_.Step(kept_);
}

bool PredictionErrorEstimator::Explained() const noexcept {
  return gain() == 0 && !segment_.windowed && !exhausted_ && pass_.excess() < 1.0;
}

void PredictionErrorEstimator::ApproachWhole() noexcept {
  ForgetLostStart();
  segment_.windowed = true;
  if (segment_.first.at_rest) {
    segment_.window = segment_.first;
  } else if (pass_.twin().linear()) {
    pass_.StartSettling(kept_, segment_.first.origin, segment_.window);
  } else {
    segment_.window = segment_.first;
    segment_.window.known = segment_.first.known = false;
  }
  const Index length = kept_.added() - segment_.window.origin;
  StartOver(pass_.stiffest(), nominal_);
  while (true) {
    for (int i = 0; i < kPulledPasses; ++i) {
      if (i > 0) GoBack();
      RunToTheEnd();
      if (pass_.information().SquaredChange() < kNear) break;
    }
    const std::size_t softer = Softer(gain(), length / 2);
    if (softer == 0) break;
    Begin(softer, NextTheta());
  }
  segment_.windowed = false;
  Begin(0, NextTheta());
  RunToTheEnd();
}

double PredictionErrorEstimator::Nis() const noexcept {
  const double nis = pass_.nis();
  return std::isfinite(nis) ? nis : std::numeric_limits<double>::infinity();
}

double PredictionErrorEstimator::NisOf(const VectorXd& theta, Index until) noexcept {
  Begin(0, theta);
  while (!CaughtUp() && pass_.seen() < until) pass_.Step(kept_);
  return Nis();
}

void PredictionErrorEstimator::TryFarNumbers() noexcept {
  next_ = far_;
  WidenPrior();
  Begin(0, far_);
  while (!CaughtUp() && !pass_.normalized().NoChance()) pass_.Step(kept_);
  // Where it fails something can be told of what would not.
  const Index failed = pass_.seen() - now().origin;
  const Index until = now().origin + std::max(kFarLook, 4 * failed);
  double least = std::numeric_limits<double>::infinity();
  Index which = 0;
  double where = far_[0];
  for (Index i = 0; i < far_.size(); ++i) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
    if (!unknown.wears || unknown.reach == 0.0) continue;
    const double from = far_[i];
    for (const double factor : kFarFactors) {
      far_[i] = unknown.nominal + std::log(factor) / unknown.reach;
      const double nis = NisOf(far_, until);
      if (!(nis < least)) continue;
      least = nis;
      which = i;
      where = far_[i];
    }
    far_[i] = from;
  }
  far_[which] = where;
}

void PredictionErrorEstimator::ApproachFromFar() noexcept {
  // What damps a resonance is seen by how long it rings: with a hundredth of it the first
  // order of nominal is wrong about every tick, and passes that are pulled along do not
  // let it ring. So each number alone is tried at sizes between which passes find their
  // way, and beside what was found another one.
  const Index end = kept_.added();
  nearest_ = pass_.theta0();
  const double before = Nis();
  double least = before;
  // A fault that large shows at once, as a start in motion does.
  const bool rest = looked_at_rest_ && !segment_.first.at_rest && segment_.since == 0 &&
                    kept_.first() == 0;
  if (rest) std::swap(segment_.first, at_rest_);
  far_ = nominal_;
  for (int number = 0; number < kFarNumbers && !Explained(); ++number) {
    TryFarNumbers();
    double nis = NisOf(far_, end);
    for (int i = 0; i < kLastPasses && !Explained(); ++i) {
      const double next = NisOf(NextTheta(), end);
      const bool worth = next < kWorthwhile * nis;
      if (next < nis) {
        nis = next;
        far_ = pass_.theta0();
      }
      if (!worth) break;
    }
    if (!(nis < least)) break;
    least = nis;
    nearest_ = far_;
  }
  if (Explained()) return;
  if (rest && !(least < before)) std::swap(segment_.first, at_rest_);
  NisOf(nearest_, end);
}

void PredictionErrorEstimator::CatchUp() noexcept {
  if (!pass_.began()) return;
  while (!CaughtUp()) ProcessKept();
  if (following()) return;
  exhausted_ = false;  // of returns while the machine ran: there is time for more
  if (!Explained()) ApproachWhole();
  if (!Explained()) ApproachFromFar();
  for (int i = 0; i < kLastPasses; ++i) {
    if (pass_.information().SquaredChange() < kThere) break;
    GoBack();
    RunToTheEnd();
  }
  Retract();
  Say();
  exhausted_ = !Explained();
}

}  // namespace mjdiag
