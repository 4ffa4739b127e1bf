// The last fits of a discovery: of free simulation, without causes that turn out to be
// nothing, and with the derivatives that intervals are made of.

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
  if (measurements_.unseen.empty() || found.train <= kFarAboveNoise) return;
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
  search_.evidence = search_.evidence.Changed(
      FitCauses(problem_, candidates_, fit,
                {.iterations = 0, .jacobian = false, .closing = true}));
  free_fit_.emplace(free, std::move(fit));
}

/// A cause of which every size may be nothing, with those intervals of all parameters;
/// none if there is no such cause. What was learned has knots, no sizes.
std::optional<std::size_t> Discoverer::EmptyCause(
    const std::vector<Interval>& intervals) const {
  const CauseFit& fit = LastFit();
  std::size_t place = 0;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    int sizes = 0;
    int empty = 0;
    for (const FitParameter& parameter :
         candidates_[fit.causes[i].candidate].parameters) {
      const Interval& interval = intervals[place++];
      if (IsShape(parameter.role)) continue;
      ++sizes;
      const bool told = std::isfinite(interval.min) && std::isfinite(interval.max);
      const bool holds_nothing =
          interval.min <= parameter.nothing && interval.max >= parameter.nothing;
      empty += told && holds_nothing ? 1 : 0;
    }
    const bool is_curve = curves_.contains(fit.causes[i].candidate);
    if (sizes > 0 && empty == sizes && !is_curve) return i;
  }
  return std::nullopt;
}

/// The others are fitted without it, or, where there is no work left, stay as they are.
void Discoverer::LeaveOut(std::size_t cause) {
  constexpr int kSteps = 6;
  const FittedModel rest = ModelWithout(LastFit(), {cause});
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
    const auto empty = EmptyCause(QuadraticIntervals());
    if (!empty) return;
    LeaveOut(*empty);
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
