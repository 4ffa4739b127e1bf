// The last fits of a discovery: of free simulation, without causes that turn out to be
// nothing, and with the derivatives that intervals are made of.

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/discovery/record_replay.h"
#include "mjdiag/discovery/selection/model_choice.h"

namespace mjdiag {

using Eigen::Index;

/// Beside a rest far above noise every value of a fit takes over some of what the model
/// lacks, and what it takes over depends on what is fitted. People use a model to simulate:
/// the last fit is one of free simulation, if that is better on records that no fit saw.
void Discoverer::FitFree() {
  const CauseFit& found = search_.fit();
  if (force_ || falls_ || measurements_.unseen.empty() || found.train <= kFarAboveNoise)
    return;
  if (found.causes.empty() || !work_->MayBegin("fit of free simulation")) return;
  Report("fit of free simulation", 0.9, found);
  const DiscoveryProblem free = problem_.Simulating([this](const Changes& changes) {
    return FreeErrors(measurements_.fit, changes);
  });
  const auto unseen = [&](const FittedModel& model) {
    return UnseenFree(ChangesOf(problem_, candidates_, model));
  };
  auto start = TryFit(free, candidates_, found, {.iterations = 0, .jacobian = false});
  if (!start) return;
  start->prior_weight =
      Inflation(start->train, IndependentShare(free, start->residual));
  auto fit = TryFit(
      free, candidates_, *start,
      {.iterations = 12, .tolerance = 1e-4, .secant = true, .share = work_->Share(1)});
  if (!fit || unseen(*fit) >= unseen(found)) return;
  TakeFree(free, std::move(*fit));
}

void Discoverer::TakeFree(const DiscoveryProblem& free, CauseFit fit) {
  search_.evidence = search_.evidence.Changed(AsItIs(problem_, candidates_, fit));
  free_fit_.emplace(free, std::move(fit));
}

/// Squared innovations that there are more of by chance without a cause that is nothing.
double Discoverer::LossByChance(std::size_t cause) const {
  constexpr double kLevel = 0.05;
  const CauseFit& fit = LastFit();
  const auto sizes = std::ranges::count_if(
      candidates_[fit.causes[cause].candidate].parameters,
      [](const FitParameter& parameter) { return !IsShape(parameter.role); });
  return GainByChance(kLevel, 1, static_cast<int>(sizes)) *
         Inflation(fit.train, IndependentShare(LastProblem(), fit.residual));
}

/// A cause of which every size may be nothing, with those intervals of all parameters, and
/// which is not known to be needed; none if there is no such cause. What was learned has
/// knots, no sizes. Where a cause is needed its intervals, which are no better than the
/// derivatives of what sticks and slips, become those of what is lost without it: as wide
/// as would make that a chance.
std::optional<std::size_t> Discoverer::EmptyCause(
    std::vector<Interval>& intervals) const {
  const CauseFit& fit = LastFit();
  std::size_t next = 0;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    const std::size_t first = next;
    const auto& parameters = candidates_[fit.causes[i].candidate].parameters;
    next += parameters.size();
    if (curves_.contains(fit.causes[i].candidate)) continue;
    std::vector<std::size_t> sizes;
    bool empty = true;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (IsShape(parameters[k].role)) continue;
      const Interval& interval = intervals[first + k];
      sizes.push_back(k);
      empty = empty && std::isfinite(interval.min) && std::isfinite(interval.max) &&
              interval.min <= parameters[k].nothing &&
              interval.max >= parameters[k].nothing;
    }
    if (sizes.empty() || !empty) continue;
    const auto lost = losses_.find(fit.causes[i].candidate);
    if (lost == losses_.end()) return i;
    const double wide = std::sqrt(LossByChance(i) / lost->second);
    for (const std::size_t k : sizes) {
      const double value = fit.causes[i].value[static_cast<Index>(k)];
      const double half = wide * std::abs(value - parameters[k].nothing);
      intervals[first + k] = {value - half, value + half};
    }
  }
  return std::nullopt;
}

/// Leaves a cause out where the others, fitted without it or, if no work is left, as they
/// are, do as well but for chance. Else what is lost is kept.
void Discoverer::TryToLeaveOut(std::size_t cause) {
  constexpr int kSteps = 6;
  const CauseFit& last = LastFit();
  const FittedModel rest = ModelWithout(last, {cause});
  std::optional<CauseFit> fit;
  if (work_->MayBegin("a fit without causes that are nothing")) {
    FitOptions options = CompareFrom(nullptr, kSteps, 1e-5, work_->Share(1));
    options.jacobian = true;
    fit = TryFit(LastProblem(), candidates_, rest, options);
  }
  if (!fit) {
    fit =
        FitCauses(LastProblem(), candidates_, rest, {.iterations = 0, .closing = true});
  }
  const auto squares = [&](const CauseFit& one) {
    return FittedValues(LastProblem()) * one.train + last.prior_weight * one.prior;
  };
  const double loss = squares(*fit) - squares(last);
  if (loss > LossByChance(cause)) {
    losses_[last.causes[cause].candidate] = loss;
    return;
  }
  search_.rivals.erase(search_.rivals.begin() + static_cast<std::ptrdiff_t>(cause));
  if (free_fit_) {
    TakeFree(DiscoveryProblem(LastProblem()), std::move(*fit));
  } else {
    search_.evidence = search_.evidence.Changed(std::move(*fit));
  }
}

/// What comes later may take over what a cause was found by. A name whose sizes may all be
/// nothing says nothing.
void Discoverer::DropEmptyCauses() {
  while (LastFit().jacobian.cols() > 0 && !LastFit().causes.empty()) {
    std::vector<Interval> intervals = QuadraticIntervals();
    const auto empty = EmptyCause(intervals);
    if (!empty) return;
    TryToLeaveOut(*empty);
  }
}

/// 95 % intervals of the parameters of all causes, as far as the likelihood is quadratic.
std::vector<Interval> Discoverer::QuadraticIntervals() const {
  const CauseFit& fit = LastFit();
  const Eigen::MatrixXd covariance =
      ParameterCovariance(LastProblem(), candidates_, fit);
  const double normal = TwoSidedNormalQuantile(0.05);
  const Eigen::VectorXd values = Flatten(fit.causes);
  std::vector<Interval> intervals;
  for (Index i = 0; i < values.size(); ++i) {
    const Index place = fit.numbers.size() + i;
    const double half = normal * std::sqrt(covariance(place, place));
    intervals.push_back({values[i] - half, values[i] + half});
  }
  return intervals;
}

/// The derivatives that intervals are made of, where the search ended without them.
void Discoverer::CompleteJacobian() {
  const CauseFit& fit = search_.fit();
  if (fit.exact || fit.numbers.size() + Flatten(fit.causes).size() == 0) return;
  // Without any there are no intervals; those of secants are near enough where there is
  // no time for others.
  if (fit.jacobian.cols() > 0 && !work_->MayBegin("exact intervals")) return;
  search_.evidence = search_.evidence.Changed(
      FitCauses(problem_, candidates_, fit, {.iterations = 0, .closing = true}));
}

}  // namespace mjdiag
