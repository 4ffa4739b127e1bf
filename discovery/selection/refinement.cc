#include "mjdiag/discovery/selection/refinement.h"

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/fitting/nested_law.h"
#include "mjdiag/discovery/fitting/wave_period.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::MatrixXd;

namespace {

// Contenders that are less probable beside all other causes are no alternatives.
constexpr double kConsidered = 1e-3;

void MoveToEnd(std::vector<std::vector<Contender>>& contenders, std::size_t i) {
  const auto place = contenders.begin() + static_cast<std::ptrdiff_t>(i);
  std::rotate(place, place + 1, contenders.end());
}

}  // namespace

double Refinement::CriterionOf(const CauseFit& fit) const {
  return Criterion(problem_, fit, independent_);
}

double Refinement::EarlyDeviance(const CauseFit& fit) const {
  return Deviance(fit.residual, independent_, problem_.skip, beginning_.train);
}

/// The fit of other causes; none if the beginning of the record shows that they explain
/// far less than the present ones.
/// @param known  J of the first of the causes
std::optional<CauseFit> Refinement::FitUnlessFar(const CauseFit& present,
                                                 const std::vector<FittedCause>& causes,
                                                 const MatrixXd& known) const {
  constexpr double kFar = 60.0;  // in units of the deviance
  const MatrixXd* slopes = known.cols() > 0 ? &known : nullptr;
  const auto early =
      TryFit(beginning_, candidates_, causes, CompareFrom(slopes, 8, 1e-3));
  if (!early || EarlyDeviance(*early) - EarlyDeviance(present) > kFar) {
    return std::nullopt;
  }
  return TryFit(problem_, candidates_, causes, CompareFrom(slopes, 8, 1e-5));
}

/// Fits with others in place i; none for those that are far worse. The new one comes
/// last, for J of those before it is known.
std::vector<std::optional<CauseFit>> Refinement::FitInPlace(
    const CauseFit& present, std::size_t i,
    const std::vector<FittedCause>& others) const {
  const std::vector<FittedCause> rest = Without(present.causes, i);
  const MatrixXd known = SensitivitiesWithout(present, i);
  std::vector<std::optional<CauseFit>> fits(others.size());
  ParallelFor(static_cast<int>(others.size()), [&](int number) {
    const auto k = static_cast<std::size_t>(number);
    std::vector<FittedCause> causes = rest;
    causes.push_back(others[k]);
    fits[k] = FitUnlessFar(present, causes, known);
  });
  return fits;
}

bool Refinement::ChangePeriod(CauseSet& set, std::size_t i) const {
  constexpr double kBetter = 1.0;  // in units of the criterion
  if (!HasPeriod(candidates_[set.fit.causes[i].candidate])) return false;
  bool changed = false;
  const auto others = OtherPeriods(problem_, candidates_, set.fit, i);
  for (auto& other : FitInPlace(set.fit, i, others)) {
    if (!other || CriterionOf(*other) > CriterionOf(set.fit) - kBetter) continue;
    set.fit = std::move(*other);
    changed = true;
  }
  if (changed) MoveToEnd(set.contenders, i);
  return changed;
}

void Refinement::ChangePeriods(CauseSet& set) const {
  std::size_t i = 0;
  while (i < set.fit.causes.size()) {
    i = ChangePeriod(set, i) ? 0 : i + 1;
  }
}

bool Refinement::Prune(CauseSet& set) const {
  if (set.fit.causes.size() < 2) return false;
  std::vector<std::optional<CauseFit>> fits(set.fit.causes.size());
  ParallelFor(static_cast<int>(fits.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fits[i] = FitUnlessFar(set.fit, Without(set.fit.causes, i),
                           SensitivitiesWithout(set.fit, i));
  });
  double criterion = CriterionOf(set.fit);
  std::optional<std::size_t> dropped;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i] || CriterionOf(*fits[i]) >= criterion) continue;
    criterion = CriterionOf(*fits[i]);
    dropped = i;
  }
  if (!dropped) return false;
  set.fit = std::move(*fits[*dropped]);
  set.contenders.erase(set.contenders.begin() + static_cast<std::ptrdiff_t>(*dropped));
  return true;
}

/// Those that are worth a fit in the place of cause i: a simpler law of the same kind,
/// and what a screening without that cause finds to explain nearly as much.
std::vector<FittedCause> Refinement::Challengers(const CauseFit& fit,
                                                 std::size_t i) const {
  constexpr std::size_t kMost = 3;
  // Of what the cause explains; the first order is rough for large effects.
  constexpr double kNearly = 0.8;
  constexpr double kChance = 50.0;
  std::vector<FittedCause> challengers;
  const auto consider = [&](const FittedCause& other) {
    const auto same = [&](const FittedCause& c) {
      return c.candidate == other.candidate;
    };
    if (std::ranges::any_of(fit.causes, same)) return;
    if (std::ranges::any_of(challengers, same)) return;
    if (challengers.size() < kMost) challengers.push_back(other);
  };
  const auto simpler = SimplerLaw(problem_.machine.plant(), candidates_, fit.causes[i]);
  if (simpler) consider(*simpler);
  const Screening without = ScreenBeside(problem_, candidates_, Without(fit.causes, i),
                                         SensitivitiesWithout(fit, i), 1);
  const double explained = without.rest - FittedValues(problem_) * fit.train;
  for (const Start& start : without.starts) {
    if (start.gain < kNearly * explained - kChance) break;
    consider(FittedFrom(candidates_, start));
  }
  return challengers;
}

bool Refinement::ExchangeAt(CauseSet& set, std::size_t i) const {
  const std::vector<FittedCause> challengers = Challengers(set.fit, i);
  auto fits = FitInPlace(set.fit, i, challengers);
  std::vector<Contender>& contenders = set.contenders[i];
  const double present = CriterionOf(set.fit);
  const auto of = [](std::size_t candidate) {
    return [candidate](const Contender& c) { return c.cause.candidate == candidate; };
  };
  const FittedCause& occupant = set.fit.causes[i];
  const auto now = std::ranges::find_if(contenders, of(occupant.candidate));
  // Those that are not tried stay as far behind it as they were.
  const double shift = now == contenders.end() ? 0.0 : present - now->criterion;
  for (Contender& contender : contenders) contender.criterion += shift;
  std::erase_if(contenders, of(occupant.candidate));
  contenders.push_back({occupant, present, 0.0});
  // Unseen data are replayed only if the criterion likes another.
  std::optional<double> least;
  std::optional<std::size_t> better;
  for (std::size_t k = 0; k < challengers.size(); ++k) {
    std::erase_if(contenders, of(challengers[k].candidate));
    if (!fits[k]) continue;
    const double criterion = CriterionOf(*fits[k]);
    contenders.push_back({fits[k]->causes.back(), criterion, 0.0});
    if (criterion >= present) continue;
    if (!least) least = present + unseen_(set.fit);
    const double with_unseen = criterion + unseen_(*fits[k]);
    if (with_unseen >= *least) continue;
    least = with_unseen;
    better = k;
  }
  Rank(contenders);
  std::erase_if(contenders, [](const Contender& contender) {
    return contender.probability < kConsidered;
  });
  if (!better) return false;
  set.fit = std::move(*fits[*better]);
  MoveToEnd(set.contenders, i);
  return true;
}

bool Refinement::Exchange(CauseSet& set) const {
  for (std::size_t i = 0; i < set.fit.causes.size(); ++i) {
    if (ExchangeAt(set, i)) return true;
  }
  return false;
}

}  // namespace mjdiag
