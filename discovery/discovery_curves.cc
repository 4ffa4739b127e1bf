// What a discovery learns of physics that has no name: a force at a joint as a curve
// over what predicts it, beside the causes that have been found.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/selection/comparator.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/moves.h"
#include "mjdiag/discovery/selection/search_data.h"
#include "mjdiag/discovery/selection/verdict.h"
#include "mjdiag/discovery/unexplained/learned_curve.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kCurve = "a curve for what has no name";

/// "0.67 N rms at Y that follow X velocity times direction (cubic, odd)".
std::string InWords(const UnknownSignal& force, const Signature& signature) {
  const double rms = std::sqrt(signature.explained_share * force.value.squaredNorm() /
                               static_cast<double>(force.value.size()));
  std::string text = FormatQuantity(rms, force.unit) + " rms at " + force.site +
                     " that follow " + signature.variable;
  if (!signature.factor.empty()) text += " times " + signature.factor;
  return text + " (" + signature.shape + ")";
}

}  // namespace

Discoverer::Rest Discoverer::SignatureOf(
    const ObservedMotion& motion, const std::vector<UnknownSignal>& forces) const {
  const auto strength = [](const UnknownSignal& s) {
    return s.value.norm() / std::max(s.sd, 1e-300);
  };
  Rest rest;
  rest.force = *std::ranges::max_element(forces, std::less<>(), strength);
  const auto& coordinates = problem_.machine().linear().coordinates;
  rest.joint = std::ranges::find(coordinates, rest.force.site) - coordinates.begin();
  std::vector<std::string> joints;
  for (const UnknownSignal& force : forces) joints.push_back(force.site);
  rest.variables =
      MotionVariables(problem_.machine(), motion, joints, rest.joint,
                      problem_.StillSpeed()[rest.joint], problem_.run().records.size());
  const std::vector<Variable> variables(rest.variables.begin(), rest.variables.end());
  rest.signature = FindSignature(rest.force.site, rest.force.value, rest.force.unit,
                                 std::max(rest.force.sd, 1e-300), variables);
  return rest;
}

bool Discoverer::IsMoreLeft() const {
  return search_.significant_rest || search_.fit().train > kFarAboveNoise;
}

/// A curve for what is left; with as many knots as the evidence is for. False if there
/// is none, or nothing that it would be over.
bool Discoverer::LearnCurve(const EvidenceData& data) {
  constexpr std::array<int, 3> kKnots = {5, 9, 16};
  constexpr double kFalseAlarm = 1e-4;
  const Evidence present(data, search_.fit(), search_.evidence.independent());
  const Track track = problem_.Follow(ChangesOf(problem_, candidates_, present.fit()));
  const ObservedMotion motion = problem_.MotionOf(track);
  const Rest rest = SignatureOf(motion, UnexplainedIn(track));
  if (!rest.signature.significant || rest.signature.variable.empty()) return false;
  const Site site{rest.force.site, rest.joint, -1};
  const double spread =
      ScalesOf({problem_.machine().plant(), problem_.machine().linear(), motion, site})
          .force;
  // As a search that asked every variable with every factor.
  const Chance chance{kFalseAlarm, 3 * static_cast<int>(rest.variables.size()), 0.0};
  std::optional<Evidence> best;
  const std::size_t place = candidates_.size();
  Candidate chosen;
  LawAxis axis;
  for (const int knots : kKnots) {
    if (!work_->MayBegin(kCurve)) break;
    auto learned = mjdiag::LearnCurve(rest.force, rest.signature, rest.variables,
                                      motion, rest.joint, spread, knots);
    if (!learned) return false;
    axis = {std::move(learned->x), learned->over, learned->unit};
    candidates_.resize(place);
    candidates_.push_back(std::move(learned->candidate));
    FittedModel start = present.fit();
    start.causes.push_back({place, learned->start});
    constexpr int kIterations = 12;
    auto fit = TryFit(
        problem_, candidates_, start,
        CompareFrom(&present.fit().jacobian, kIterations, 1e-4, work_->Share(1)));
    if (!fit) continue;
    VectorXd independent = IndependentShare(problem_, fit->residual);
    Evidence proposed = present.Added(std::move(*fit), std::move(independent), chance);
    if (mjdiag::Judge(present, proposed) != Judgement::kAccepted) continue;
    if (best && proposed.Criterion(proposed.independent()) >=
                    best->Criterion(proposed.independent())) {
      continue;
    }
    best = std::move(proposed);
    chosen = candidates_.back();
  }
  candidates_.resize(place);
  if (!best) return false;
  candidates_.push_back(std::move(chosen));
  curves_[place] = {InWords(rest.force, rest.signature), std::move(axis)};
  search_.ladder.push_back(best->fit());
  search_.rivals.emplace_back();
  search_.evidence = std::move(*best);
  // No law was left before.
  search_.significant_rest = false;
  return true;
}

/// Laws that do not explain what they were found for may be nothing beside a curve.
void Discoverer::LearnCurves(const SearchOptions& options) {
  constexpr int kMost = 2;
  const Candidate any{.effect = Lasting(ForceCurve()), .site = "", .parameters = {}};
  if (!IsChosen(any, options_.choice)) return;
  const SearchData data{
      problem_, problem_, candidates_,
      DataOf(problem_, candidates_, options.unseen, options.free_run)};
  for (int i = 0; i < kMost; ++i) {
    if (!IsMoreLeft() || !work_->MayBegin(kCurve)) return;
    Report(kCurve, 0.5);
    if (!LearnCurve(data.evidence)) return;
    while (work_->MayBegin(kCurve) && Drop(data, search_)) {
    }
  }
}

}  // namespace mjdiag
