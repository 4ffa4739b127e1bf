// What a discovery learns of physics that has no name: a force at a joint as a curve
// over what predicts it, beside the causes that have been found.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

/// Whether a force at the joint is no curve over it: accelerations, and commands of the
/// joint's own motors, answer to the force.
bool IsAnswer(const MotionVariable& variable, const MechanicalModel& model,
              Index joint) {
  if (variable.kind == CurveVariable::kCommand) {
    return model.Gamma(joint, variable.of) != 0.0;
  }
  return !variable.kind && variable.factor == CurveFactor::kNone;
}

/// Whether a force without a name does what the laws do in whose place it came, however
/// many knots it has.
bool ExplainsAsWell(const Evidence& laws, const Evidence& curve) {
  constexpr double kChance = 10.0;  // units of the deviance
  const double more = curve.Noise() * (curve.fit().train - laws.fit().train);
  const VectorXd& independent = curve.independent();
  return more <= kChance * std::max(1.0, laws.fit().train) &&
         curve.Unseen(independent) <= laws.Unseen(independent) + kChance;
}

}  // namespace

Discoverer::Rest Discoverer::SignatureOf(const ObservedMotion& motion,
                                         const std::vector<UnknownSignal>& forces,
                                         bool for_curve) const {
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
  if (for_curve) {
    std::erase_if(rest.variables, [&](const MotionVariable& variable) {
      return IsAnswer(variable, problem_.machine().linear(), rest.joint);
    });
  }
  const std::vector<Variable> variables(rest.variables.begin(), rest.variables.end());
  rest.signature = FindSignature(rest.force.site, rest.force.value, rest.force.unit,
                                 std::max(rest.force.sd, 1e-300), variables);
  return rest;
}

/// A curve for what is left beside `base`, the present set or part of it, with as many
/// knots as the evidence is for, or the wave that it is. False if there is none, or nothing
/// that it would be over.
bool Discoverer::LearnCurve(const EvidenceData& data, const FittedModel& base) {
  constexpr std::array<int, 3> kKnots = {5, 9, 16};
  constexpr double kFalseAlarm = 1e-4;
  const Evidence present(data, search_.fit(), search_.evidence.independent());
  const bool adds = base.causes.size() == present.hypotheses();
  // So many laws of one variable are the series of another one.
  constexpr std::size_t kSeries = 3;
  const bool is_series = base.causes.size() + kSeries <= present.hypotheses();
  const Changes changes = ChangesOf(problem_, candidates_, base);
  const Track track = problem_.Follow(changes);
  const ObservedMotion motion = problem_.MotionOf(track);
  const Rest rest = SignatureOf(motion, UnexplainedIn(track, changes), true);
  if (!rest.signature.significant || rest.signature.variable.empty()) return false;
  const Site site{rest.force.site, rest.joint, -1};
  const double spread =
      ScalesOf({problem_.machine().plant(), problem_.machine().linear(), motion, site})
          .force;
  // As a search that asked every variable with every factor.
  const Chance chance{kFalseAlarm, 3 * static_cast<int>(rest.variables.size()), 0.0};
  std::optional<Evidence> best;
  const auto propose = [&](const FittedCause& cause) {
    FittedModel start = base;
    start.causes.push_back(cause);
    constexpr int kIterations = 12;
    auto fit = TryFit(problem_, candidates_, start,
                      CompareFrom(adds ? &present.fit().jacobian : nullptr, kIterations,
                                  1e-4, work_->Share(1)));
    if (!fit) return false;
    VectorXd independent = IndependentShare(problem_, fit->residual);
    Evidence proposed =
        adds ? present.Added(std::move(*fit), std::move(independent), chance)
             : present.Changed(std::move(*fit));
    if (mjdiag::Judge(present, proposed) != Judgement::kAccepted &&
        !(is_series && ExplainsAsWell(present, proposed))) {
      return false;
    }
    if (best && proposed.Criterion(proposed.independent()) >=
                    best->Criterion(proposed.independent())) {
      return false;
    }
    best = std::move(proposed);
    return true;
  };
  const auto wave = WaveOf(candidates_, rest.force, rest.signature, rest.variables,
                           motion, rest.joint);
  if (wave && !Has(base.causes, wave->candidate)) propose(*wave);
  const std::size_t place = candidates_.size();
  std::optional<Candidate> chosen;
  LawAxis axis;
  for (const int knots : kKnots) {
    if (!work_->MayBegin(kCurve)) break;
    auto learned = mjdiag::LearnCurve(rest.force, rest.signature, rest.variables,
                                      motion, rest.joint, spread, knots);
    if (!learned) break;
    candidates_.push_back(std::move(learned->candidate));
    if (propose({place, learned->start})) {
      chosen = candidates_.back();
      axis = {std::move(learned->x), learned->over, learned->unit};
    }
    candidates_.pop_back();
  }
  if (!best) return false;
  if (chosen) {
    candidates_.push_back(std::move(*chosen));
    curves_[place] = {InWords(rest.force, rest.signature), std::move(axis)};
  }
  Take(std::move(*best));
  return true;
}

/// The set with the force that came last, in the place of the present one.
void Discoverer::Take(Evidence with_force) {
  std::vector<std::vector<Hypothesis>> rivals;
  for (const FittedCause& cause : with_force.fit().causes) {
    const auto& before = search_.fit().causes;
    const auto same =
        std::ranges::find(before, cause.candidate, &FittedCause::candidate);
    rivals.emplace_back();
    if (same == before.end()) continue;
    rivals.back() =
        std::move(search_.rivals[static_cast<std::size_t>(same - before.begin())]);
  }
  search_.rivals = std::move(rivals);
  search_.ladder.push_back(with_force.fit());
  search_.evidence = std::move(with_force);
  // No law was left before.
  search_.significant_rest = false;
}

/// Of the causes that are functions of one variable of one joint alone, the sets of
/// several: what many laws describe together may be one that has no name. A force that is
/// smooth has a series, of which quadratic and cubic stiffness are terms, and if there are
/// three of them it only has to explain as much.
std::vector<FittedModel> Discoverer::WithoutAlike() const {
  std::map<std::pair<Index, LawVariable>, std::vector<std::size_t>> alike;
  const std::vector<FittedCause>& causes = search_.fit().causes;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const Cause cause = CauseOf(candidates_, causes[i]);
    if (!cause.effect->Law(0.0, cause.values)) continue;
    alike[{candidates_[causes[i].candidate].joint, cause.effect->variable()}].push_back(
        i);
  }
  std::vector<FittedModel> without;
  for (const auto& [of, places] : alike) {
    if (places.size() >= 2) without.push_back(ModelWithout(search_.fit(), places));
  }
  return without;
}

/// Where the laws leave something, the sets without each of them, without all at one joint,
/// and without curves there: the force without a name may be what they imitate.
std::vector<FittedModel> Discoverer::WithoutDoubtful() const {
  const std::vector<FittedCause>& causes = search_.fit().causes;
  std::map<Index, std::vector<std::size_t>> laws;  // of every joint
  std::map<Index, std::vector<std::size_t>> curves;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const Candidate& candidate = candidates_[causes[i].candidate];
    const bool is_curve = curves_.contains(causes[i].candidate);
    if (!is_curve && candidate.effect->site() != SiteKind::kJoint) continue;
    (is_curve ? curves : laws)[candidate.joint].push_back(i);
  }
  if (!IsMoreLeft(search_) && curves.empty()) return {};
  std::vector<FittedModel> without;
  for (const auto& [joint, places] : laws) {
    const auto leave_out = [&, joint = joint](std::vector<std::size_t> left_out) {
      const std::vector<std::size_t>& too = curves[joint];
      left_out.insert(left_out.end(), too.begin(), too.end());
      without.push_back(ModelWithout(search_.fit(), left_out));
    };
    if (places.size() > 1) leave_out(places);
    for (const std::size_t place : places) leave_out({place});
  }
  return without;
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
    if (!IsMoreLeft(search_) || !work_->MayBegin(kCurve)) break;
    Report(kCurve, 0.5);
    if (!LearnCurve(data.evidence, search_.fit())) break;
    while (work_->MayBegin(kCurve) && Drop(data, search_)) {
    }
  }
  for (const FittedModel& base : WithoutAlike()) {
    if (!work_->MayBegin(kCurve)) break;
    Report(kCurve, 0.8);
    if (LearnCurve(data.evidence, base)) break;
  }
  constexpr int kRounds = 3;
  for (int i = 0; i < kRounds; ++i) {
    const std::vector<FittedModel> bases = WithoutDoubtful();
    const bool replaced = std::ranges::any_of(bases, [&](const FittedModel& base) {
      if (!work_->MayBegin(kCurve)) return false;
      Report(kCurve, 0.9);
      return LearnCurve(data.evidence, base);
    });
    if (!replaced) break;
  }
}

}  // namespace mjdiag
