// What kind of physics a machine has that its model lacks, and where, whichever the law.
// With U the deviance of data that no fit saw (evidence.h), of the answer and of the best
// model without any cause of a kind at a place,
//
//   P(needed) = 1 / (1 + exp(-(U_without - U) / 2))
//
// even odds before those data: what the fit saw has spoken for it already. Of what is
// needed there, the laws that could be in its place have their shares (Hypothesis), each
// for its own kind. A law that is in no list makes a name less probable, and its kind not.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/selection/evidence.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kLeast = 0.05;  // probability that is told,
constexpr double kRather = 0.5;  // and of numbers, of which there are many

double Logistic(double half_deviance) { return 1.0 / (1.0 + std::exp(-half_deviance)); }

}  // namespace

Kind Discoverer::KindOfCause(const FittedCause& fitted) const {
  const Candidate& candidate = candidates_[fitted.candidate];
  return curves_.contains(fitted.candidate)
             ? KindOfCurve(CauseOf(candidates_, fitted).values, candidate.joint)
             : candidate.effect->kind();
}

/// Of causes of one kind at one place, that kind and those of the laws that could be in
/// their places.
std::vector<FoundKind> Discoverer::KindsAt(const std::vector<std::size_t>& places,
                                           double needed, double share) const {
  std::map<std::pair<Kind, std::string>, double> missing;  // 1 - what all places say
  for (const std::size_t i : places) {
    const FittedCause& found = search_.fit().causes[i];
    std::map<std::pair<Kind, std::string>, double> of_place;
    double sum = 0.0;
    const auto add = [&](const FittedCause& cause, double probability) {
      of_place[{KindOfCause(cause), candidates_[cause.candidate].site}] += probability;
      sum += probability;
    };
    for (const Hypothesis& rival : search_.rivals[i]) {
      add(rival.cause, rival.probability);
    }
    if (sum == 0.0) add(found, 1.0);
    for (const auto& [of, probability] : of_place) {
      missing.try_emplace(of, 1.0).first->second *= 1.0 - probability / sum;
    }
  }
  std::vector<FoundKind> kinds;
  for (const auto& [of, none] : missing) {
    kinds.push_back({of.first, of.second, needed * (1.0 - none), share});
  }
  return kinds;
}

/// Where causes were found along the motion, the parts of it that were predicted from the
/// others tell.
void Discoverer::FindKindsAlongMotion() {
  const CauseFit& fit = search_.fit();
  std::map<std::pair<Kind, std::string>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    groups[{KindOfCause(fit.causes[i]), candidates_[fit.causes[i].candidate].site}]
        .push_back(i);
  }
  for (const auto& [of, places] : groups) {
    double loss = 0.0;
    for (const std::size_t i : places) {
      const auto found = std::ranges::find(
          force_->model.causes, fit.causes[i].candidate, &FittedCause::candidate);
      if (found == force_->model.causes.end()) continue;
      loss += force_->loss[found - force_->model.causes.begin()];
    }
    const double share = force_->loss_of_all > 0.0
                             ? std::clamp(loss / force_->loss_of_all, 0.0, 1.0)
                             : 0.0;
    for (FoundKind& kind : KindsAt(places, Logistic(loss / 2.0), share)) {
      AddKind(std::move(kind));
    }
  }
}

/// Of a kind at a place that is known, the more probable one.
void Discoverer::AddKind(FoundKind kind) {
  const auto known = std::ranges::find_if(discovery_.kinds, [&](const auto& other) {
    return other.kind == kind.kind && other.site == kind.site;
  });
  if (known == discovery_.kinds.end()) {
    discovery_.kinds.push_back(std::move(kind));
  } else if (kind.probability > known->probability) {
    *known = std::move(kind);
  }
}

void Discoverer::FindKinds() {
  if (force_) {
    FindKindsAlongMotion();
  } else {
    FindKindsBehindObserver();
  }
  AddKindsOfNumbers();
  std::erase_if(discovery_.kinds,
                [](const FoundKind& kind) { return kind.probability < kLeast; });
  std::ranges::stable_sort(discovery_.kinds, std::greater<>(), &FoundKind::probability);
}

void Discoverer::FindKindsBehindObserver() {
  constexpr int kIterations = 8;
  const CauseFit& fit = search_.fit();
  const auto deviance = [&](const Evidence& evidence) {
    return evidence.Unseen(search_.evidence.independent());
  };
  std::map<std::pair<Kind, std::string>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    if (IsOfSteps(fit.causes[i])) continue;
    groups[{KindOfCause(fit.causes[i]), candidates_[fit.causes[i].candidate].site}]
        .push_back(i);
  }
  if (!groups.empty()) Report("kinds of physics", 0.75);
  const double with = deviance(search_.evidence);
  const double squares = search_.evidence.UnseenSquares();
  const double given =
      groups.empty()
          ? 0.0
          : search_.evidence.Changed(AsItIs(problem_, candidates_, {})).UnseenSquares();
  for (const auto& [of, places] : groups) {
    const FittedModel rest = ModelWithout(fit, places);
    std::optional<CauseFit> without;
    if (work_->MayBegin("whether every kind of physics is needed")) {
      without = TryFit(problem_, candidates_, rest,
                       CompareFrom(nullptr, kIterations, 1e-4, work_->Share(1)));
    }
    double needed = 1.0;
    double share = 1.0;
    try {
      if (!without) without = AsItIs(problem_, candidates_, rest);
      const Evidence fewer = search_.evidence.Changed(std::move(*without));
      needed = Logistic((deviance(fewer) - with) / 2.0);
      if (given > squares) {
        share =
            std::clamp((fewer.UnseenSquares() - squares) / (given - squares), 0.0, 1.0);
      }
    } catch (const NumericalError&) {
      // Without it the machine cannot be run.
    }
    for (FoundKind& kind : KindsAt(places, needed, share)) AddKind(std::move(kind));
  }
}

/// Numbers of the plant that are others than the model says are a kind of physics, too. By
/// their intervals, with Bonferroni's price for how many were in doubt.
void Discoverer::AddKindsOfNumbers() {
  const double price = 2.0 * std::log(static_cast<double>(std::max<std::size_t>(
                                 1, discovery_.calibration.size())));
  for (const CalibratedNumber& number : discovery_.calibration) {
    if (!IsOff(number)) continue;
    const double sd =
        std::log(number.high / number.low) / (2.0 * TwoSidedNormalQuantile(0.05));
    const double z = std::log(number.factor) / sd;
    const Kind kind = KindOf(number.number.kind);
    const std::string site = number.name.substr(number.name.find('@') + 1);
    const bool is_known = std::ranges::any_of(discovery_.kinds, [&](const auto& other) {
      return other.kind == kind && other.site == site;
    });
    const double probability = Logistic((z * z - price) / 2.0);
    if (is_known || probability < kRather) continue;
    discovery_.kinds.push_back({kind, site, probability, 0.0, true});
  }
}

}  // namespace mjdiag
