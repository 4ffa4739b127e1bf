#include "mjdiag/discovery/selection/moves.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/discovery/fitting/first_values.h"
#include "mjdiag/discovery/fitting/nested_law.h"
#include "mjdiag/discovery/fitting/screening_in_place.h"
#include "mjdiag/discovery/fitting/wave_period.h"
#include "mjdiag/discovery/selection/comparator.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/settled_fit.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

/// Evidence of sets that a move proposes; none of those that are far worse.
using Proposals = std::vector<std::optional<Evidence>>;

// Hypotheses that are less probable beside all other causes are no alternatives.
constexpr double kConsidered = 1e-3;

constexpr const char* kAtItsEnd = "laws at their end";

void MoveToEnd(std::vector<std::vector<Hypothesis>>& rivals, std::size_t i) {
  const auto place = rivals.begin() + static_cast<std::ptrdiff_t>(i);
  std::rotate(place, place + 1, rivals.end());
}

/// Whether the last cause, which is not among the present ones, is not credible.
bool IsIncredible(const SearchData& data, const Evidence& present,
                  const CauseFit& fit) {
  if (fit.causes.empty()) return false;
  const bool is_new = !Has(present.fit().causes, fit.causes.back().candidate);
  return is_new && !IsCredible(data.candidates, fit, fit.causes.back());
}

/// The fit of a set, as far as sets are compared.
std::optional<CauseFit> FitToCompare(const SearchData& data, const FittedModel& model,
                                     const MatrixXd* jacobian, double share) {
  auto fit = TryFit(data.problem, data.candidates, model,
                    CompareFrom(jacobian, 8, 1e-5, share));
  if (fit) *fit = Settled(data.problem, data.candidates, std::move(*fit), share);
  return fit;
}

/// The fit of other causes; none if the beginning of the record shows that they explain
/// far less than the present ones. Of a law that the fit takes to an end of its
/// parameters that of the simpler one, which it is there.
/// @param jacobian  of the first of the causes
/// @param share     of the work that is left, for both fits
std::optional<Evidence> ProposeUnlessFar(const SearchData& data,
                                         const Evidence& present,
                                         const FittedModel& model,
                                         const MatrixXd& jacobian, double share) {
  constexpr double kFar = 60.0;  // in units of the deviance
  constexpr double kNear = 1.2;  // times what the present ones leave
  const MatrixXd* initial = jacobian.cols() > 0 ? &jacobian : nullptr;
  const auto early = [&](const CauseFit& fit) {
    return Deviance(fit.residual, present.independent(), data.problem.skip(),
                    data.beginning.train(),
                    data.problem.Measured(data.problem.skip(), data.beginning.train()));
  };
  const double near = kNear * MeanSquare(data.problem, present.fit().residual,
                                         data.problem.skip(), data.beginning.train());
  const bool is_new = !model.causes.empty() &&
                      !Has(present.fit().causes, model.causes.back().candidate);
  const FittedModel start =
      is_new ? WithFirstValues(data.beginning, data.candidates, model, initial, near)
             : model;
  auto rough = TryFit(data.beginning, data.candidates, start,
                      CompareFrom(initial, 8, 1e-3, 0.5 * share));
  const auto is_far = [&] { return early(*rough) - early(present.fit()) > kFar; };
  if (rough && is_far() && present.fit().numbers.size() > 0) {
    *rough = Settled(data.beginning, data.candidates, std::move(*rough), 0.5 * share);
  }
  if (!rough || is_far()) return std::nullopt;
  auto fit = FitToCompare(data, *rough, initial, 0.5 * share);
  if (!fit) return std::nullopt;
  if (!IsIncredible(data, present, *fit)) return present.Changed(std::move(*fit));
  const auto simpler = data.AtItsEnd(*fit);
  if (!simpler || Has(present.fit().causes, simpler->causes.back().candidate)) {
    return std::nullopt;
  }
  return ProposeUnlessFar(data, present, *simpler, jacobian, share - fit->spent);
}

/// Sets with others in these places. The new one comes last, for the Jacobian of those
/// before it is known.
Proposals ProposeInPlace(const SearchData& data, const Evidence& present,
                         const std::vector<std::size_t>& places,
                         const std::vector<FittedCause>& others) {
  const FittedModel rest = ModelWithout(present.fit(), places);
  const MatrixXd jacobian = JacobianWithout(present.fit(), places);
  Proposals proposals(others.size());
  const double share = data.work().Share(static_cast<int>(others.size()));
  ParallelFor(static_cast<int>(others.size()), [&](int number) {
    const auto k = static_cast<std::size_t>(number);
    FittedModel other = rest;
    other.causes.push_back(others[k]);
    proposals[k] = ProposeUnlessFar(data, present, other, jacobian, share);
  });
  return proposals;
}

/// Whether a set without cause i is worth no fit: to first order, which is rough, it is
/// far worse many times over.
bool IsIndispensable(const SearchData& data, const Evidence& present, std::size_t i) {
  constexpr double kFar = 1000.0;  // in units of the deviance
  const CauseFit& fit = present.fit();
  const double loss = LossWithout(data.problem, data.candidates, fit, i);
  const double rest = FittedValues(data.problem) * std::max(1.0, fit.train);
  const double values = present.Noise() * present.independent().mean();
  return values * std::log1p(loss / rest) > kFar;
}

/// Sets without each of the hypotheses.
Proposals ProposeDrops(const SearchData& data, const Evidence& present) {
  const CauseFit& fit = present.fit();
  Proposals proposals(fit.causes.size());
  const double share = data.work().Share(static_cast<int>(proposals.size()));
  ParallelFor(static_cast<int>(proposals.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    if (IsIndispensable(data, present, i)) return;
    proposals[i] = ProposeUnlessFar(data, present, ModelWithout(fit, {i}),
                                    JacobianWithout(fit, {i}), share);
  });
  return proposals;
}

/// What could stand in the place of some of the causes.
struct Substitutes {
  std::vector<Start> starts;  ///< best first
  int trials = 0;             ///< of which they are the best
  double explained = 0.0;     ///< by the causes themselves
  /// What the screening promises of a cause that is alone in its place: what the first
  /// order is off by is much the same for laws that explain alike. Else as `explained`.
  double promised = 0.0;
};

Substitutes SubstitutesFor(const SearchData& data, const CauseFit& fit,
                           const std::vector<std::size_t>& places) {
  Screening without = ScreenInPlace(data.problem, data.candidates, fit, places, 1);
  Substitutes found;
  found.trials = without.trials;
  found.explained = ExplainedBy(data.problem, fit, without);
  found.promised = found.explained;
  for (Start& start : without.starts) {
    const std::size_t candidate = start.cause.candidate;
    if (places.size() == 1 && candidate == fit.causes[places.front()].candidate) {
      found.promised = start.gain;
    }
    if (Has(fit.causes, candidate) || data.IsForbidden(candidate)) continue;
    start.cause = Bounded(data.candidates, std::move(start.cause));
    found.starts.push_back(std::move(start));
  }
  return found;
}

/// Those that explain nearly so much, best first: the first order is rough for large
/// effects.
std::vector<FittedCause> Explaining(const Substitutes& substitutes, double explained) {
  constexpr double kNearly = 0.8;
  constexpr double kChance = 50.0;
  std::vector<FittedCause> others;
  for (const Start& start : substitutes.starts) {
    if (start.gain < kNearly * explained - kChance) break;
    others.push_back(start.cause);
  }
  return others;
}

/// The best of these that contains cause i as a simpler law, with values next to its own.
std::optional<FittedCause> LargerThan(const SearchData& data, const FittedCause& cause,
                                      const std::vector<FittedCause>& others) {
  const mjModel& plant = data.problem.machine().plant();
  const auto contains = [&](const FittedCause& other) {
    const auto simpler = SimplerLaw(plant, data.candidates, other);
    return simpler && simpler->candidate == cause.candidate;
  };
  const auto larger = std::ranges::find_if(others, contains);
  if (larger == others.end()) return std::nullopt;
  return Containing(plant, data.candidates, *larger, cause);
}

/// Hypotheses that are worth a fit in the place of cause i: a simpler law of the same
/// kind, the best that contains it, and what a screening without that cause finds to
/// explain nearly as much.
std::vector<FittedCause> OthersFor(const SearchData& data, const CauseFit& fit,
                                   std::size_t i) {
  constexpr std::size_t kMost = 4;
  std::vector<FittedCause> others;
  if (const auto simpler = data.SimplerThan(fit.causes[i], fit)) {
    others.push_back(*simpler);
  }
  const Substitutes found = SubstitutesFor(data, fit, {i});
  const std::vector<FittedCause> all =
      Explaining(found, std::min(found.explained, found.promised));
  if (auto larger = LargerThan(data, fit.causes[i], all)) {
    others.push_back(std::move(*larger));
  }
  for (const FittedCause& other : all) {
    if (others.size() == kMost) break;
    if (!Has(others, other.candidate)) others.push_back(other);
  }
  return others;
}

/// Hypotheses that promise more than cause i, by more than chance, and the best law that
/// contains it: what that has beyond it may not show to first order.
std::vector<FittedCause> BetterFor(const SearchData& data, const Evidence& present,
                                   std::size_t i, const Chance& chance) {
  constexpr std::size_t kMost = 2;
  const CauseFit& fit = present.fit();
  const Substitutes found = SubstitutesFor(data, fit, {i});
  const Chance best{chance.probability, found.trials, chance.unsteadiness};
  std::vector<FittedCause> better;
  for (const Start& start : found.starts) {
    const Significance more = present.SignificanceOf(start.gain - found.promised, 1,
                                                     best, present.independent());
    if (better.size() == kMost || !more.IsMoreThanChance()) break;
    better.push_back(start.cause);
  }
  auto larger = LargerThan(data, fit.causes[i], Explaining(found, found.promised));
  if (larger && !Has(better, larger->candidate)) better.push_back(std::move(*larger));
  return better;
}

/// The rivals of cause i after others have been tried in its place. Those that were not
/// tried stay as far behind the cause as they were; tried ones without a fit go.
void RankRivals(HypothesisSet& set, std::size_t i,
                const std::vector<FittedCause>& tried, const Proposals& proposals) {
  std::vector<Hypothesis>& rivals = set.rivals[i];
  const FittedCause& cause = set.fit().causes[i];
  const auto of = [](std::size_t candidate) {
    return [candidate](const Hypothesis& h) { return h.cause.candidate == candidate; };
  };
  const double present = set.evidence.Criterion();
  const auto before = std::ranges::find_if(rivals, of(cause.candidate));
  const double shift = before == rivals.end() ? 0.0 : present - before->criterion;
  for (Hypothesis& rival : rivals) rival.criterion += shift;
  std::erase_if(rivals, of(cause.candidate));
  rivals.push_back({cause, present, 0.0});
  for (std::size_t k = 0; k < tried.size(); ++k) {
    std::erase_if(rivals, of(tried[k].candidate));
    // What unseen data contradict is no alternative, however well it fits.
    if (!proposals[k] || Judge(set.evidence, *proposals[k]) == Judgement::kUnseen) {
      continue;
    }
    rivals.push_back(
        {proposals[k]->fit().causes.back(), proposals[k]->Criterion(), 0.0});
  }
  Rank(rivals);
  std::erase_if(rivals,
                [](const Hypothesis& h) { return h.probability < kConsidered; });
}

/// Takes the best of the sets that have another cause in place i; it is their last.
bool TakeInPlace(HypothesisSet& set, std::size_t i, Proposals proposals) {
  const auto best = BestOf(set.evidence, proposals);
  if (!best) return false;
  set.evidence = std::move(*proposals[*best]);
  MoveToEnd(set.rivals, i);
  return true;
}

bool ChangePeriod(const SearchData& data, HypothesisSet& set, std::size_t i) {
  const CauseFit& fit = set.fit();
  if (!HasPeriod(data.candidates[fit.causes[i].candidate])) return false;
  if (!data.work().MayBegin("other periods")) return false;
  const auto others = OtherPeriods(data.problem, data.candidates, fit, i);
  return TakeInPlace(set, i, ProposeInPlace(data, set.evidence, {i}, others));
}

bool ExchangeAt(const SearchData& data, HypothesisSet& set, std::size_t i,
                const std::vector<FittedCause>& others) {
  Proposals proposals = ProposeInPlace(data, set.evidence, {i}, others);
  // Fits that were cut short say nothing of how probable the rivals are; one that is
  // better all the same is.
  if (!data.work().MayBegin(kOthers) && !BestOf(set.evidence, proposals)) return false;
  RankRivals(set, i, others, proposals);
  return TakeInPlace(set, i, std::move(proposals));
}

/// Puts one hypothesis in the place of two that act at one joint.
bool MergeAt(const SearchData& data, HypothesisSet& set, std::size_t i, std::size_t j) {
  constexpr std::size_t kMost = 2;
  const CauseFit& fit = set.fit();
  const Substitutes found = SubstitutesFor(data, fit, {i, j});
  std::vector<FittedCause> others = Explaining(found, found.explained);
  if (others.size() > kMost) others.resize(kMost);
  if (others.empty()) return false;
  Proposals proposals = ProposeInPlace(data, set.evidence, {i, j}, others);
  const auto best = BestOf(set.evidence, proposals);
  if (!best) return false;
  set.evidence = std::move(*proposals[*best]);
  set.rivals.erase(set.rivals.begin() + static_cast<std::ptrdiff_t>(j));
  set.rivals.erase(set.rivals.begin() + static_cast<std::ptrdiff_t>(i));
  set.rivals.push_back({{set.fit().causes.back(), set.evidence.Criterion(), 1.0}});
  return true;
}

/// Takes cause i out of the set, or puts the law that it is at its end in its place, even
/// if that is worse; false if neither can be fitted.
bool GiveUp(const SearchData& data, HypothesisSet& set, std::size_t i) {
  const CauseFit& fit = set.fit();
  const MatrixXd jacobian = JacobianWithout(fit, {i});
  const MatrixXd* initial = jacobian.cols() > 0 ? &jacobian : nullptr;
  std::vector<FittedModel> models{ModelWithout(fit, {i})};
  if (const auto simpler = data.SimplerThan(fit.causes[i], fit)) {
    models.push_back(models.front());
    models.back().causes.push_back(*simpler);
  }
  const double share = data.work().Share(static_cast<int>(models.size()));
  std::optional<Evidence> best;
  for (const FittedModel& model : models) {
    auto other = FitToCompare(data, model, initial, share);
    if (!other) continue;
    Evidence evidence = set.evidence.Changed(std::move(*other));
    if (!best || evidence.Criterion() < best->Criterion()) best = std::move(evidence);
  }
  if (!best) return false;
  set.evidence = std::move(*best);
  set.rivals.erase(set.rivals.begin() + static_cast<std::ptrdiff_t>(i));
  if (set.fit().causes.size() > set.rivals.size()) {
    set.rivals.push_back({{set.fit().causes.back(), set.evidence.Criterion(), 1.0}});
  }
  return true;
}

}  // namespace

void ChangePeriods(const SearchData& data, HypothesisSet& set) {
  std::size_t i = 0;
  while (i < set.fit().causes.size()) {
    i = ChangePeriod(data, set, i) ? 0 : i + 1;
  }
}

bool Simplify(const SearchData& data, HypothesisSet& set) {
  for (std::size_t i = 0; i < set.fit().causes.size(); ++i) {
    const auto simpler = data.SimplerThan(set.fit().causes[i], set.fit());
    if (!simpler || !data.work().MayBegin("simpler laws")) continue;
    if (ExchangeAt(data, set, i, {*simpler})) return true;
  }
  return false;
}

bool Drop(const SearchData& data, HypothesisSet& set) {
  if (set.fit().causes.empty()) return false;
  Proposals proposals = ProposeDrops(data, set.evidence);
  const auto dropped = BestOf(set.evidence, proposals);
  if (!dropped) return false;
  set.evidence = std::move(*proposals[*dropped]);
  set.rivals.erase(set.rivals.begin() + static_cast<std::ptrdiff_t>(*dropped));
  return true;
}

bool GiveUpIncredible(const SearchData& data, HypothesisSet& set) {
  for (std::size_t i = 0; i < set.fit().causes.size(); ++i) {
    if (IsCredible(data.candidates, set.fit(), set.fit().causes[i])) continue;
    if (data.work().MayBegin(kAtItsEnd) && GiveUp(data, set, i)) return true;
  }
  return false;
}

bool Exchange(const SearchData& data, HypothesisSet& set) {
  for (std::size_t i = 0; i < set.fit().causes.size(); ++i) {
    if (!data.work().MayBegin(kOthers)) break;
    if (ExchangeAt(data, set, i, OthersFor(data, set.fit(), i))) return true;
  }
  return false;
}

bool Better(const SearchData& data, HypothesisSet& set, const Chance& chance) {
  for (std::size_t i = 0; i < set.fit().causes.size(); ++i) {
    if (!data.work().MayBegin(kBetter)) break;
    const auto better = BetterFor(data, set.evidence, i, chance);
    if (!better.empty() && ExchangeAt(data, set, i, better)) return true;
  }
  return false;
}

bool Merge(const SearchData& data, HypothesisSet& set) {
  const std::vector<FittedCause>& causes = set.fit().causes;
  const auto joint = [&](std::size_t i) {
    const Candidate& candidate = data.candidates[causes[i].candidate];
    return candidate.effect->element() == mjOBJ_JOINT ? candidate.joint : -1;
  };
  for (std::size_t i = 0; i + 1 < causes.size(); ++i) {
    for (std::size_t j = i + 1; j < causes.size(); ++j) {
      if (joint(i) < 0 || joint(i) != joint(j)) continue;
      if (!data.work().MayBegin(kOthers)) return false;
      if (MergeAt(data, set, i, j)) return true;
    }
  }
  return false;
}

}  // namespace mjdiag
