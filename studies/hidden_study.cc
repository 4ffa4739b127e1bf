#include "mjdiag/studies/hidden_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

/// Whether a wave's amplitude is negative: a sine of a negative one is a sine of another
/// phase.
bool IsTurned(const Cause& cause) {
  const auto phase = cause.effect->Find(Role::kPhase);
  const auto amplitude = cause.effect->Find(Role::kAmplitude);
  return phase && amplitude && cause.values[*amplitude] < 0.0;
}

/// Its values with an amplitude >= 0.
Eigen::VectorXd Normalised(const Cause& cause) {
  Eigen::VectorXd values = cause.values;
  if (!IsTurned(cause)) return values;
  values[cause.effect->Find(Role::kAmplitude).value()] *= -1.0;
  values[cause.effect->Find(Role::kPhase).value()] += std::numbers::pi;
  return values;
}

/// Whether a true value lies in the interval, an end of which may be missing; one
/// without both says nothing and covers nothing. Phases up to whole turns.
bool Covers(const CauseParameter& parameter, Role role, double truth, double shift) {
  double off = truth - (parameter.value + shift);
  if (role == Role::kPhase) off = std::remainder(off, 2.0 * std::numbers::pi);
  return (std::isfinite(parameter.low) || std::isfinite(parameter.high)) &&
         off >= parameter.low - parameter.value &&
         off <= parameter.high - parameter.value;
}

/// The value of that kind which is the same change of the model; none if none is.
std::optional<double> TwinValue(const mjModel& plant, Cause cause, double value,
                                const Cause& kind) {
  cause.values[0] = value;
  for (const Cause& twin : EquivalentCauses(plant, cause)) {
    if (SameKind(twin, kind)) return twin.values[0];
  }
  return std::nullopt;
}

void CountParameters(const mjModel& plant, const FoundCause& found, const Cause& truth,
                     HiddenOutcome& outcome) {
  if (!SameKind(found.cause, truth)) {
    // A fault parameter for an effect or the other way round: the interval of the twin
    // is that of the one found.
    const CauseParameter& parameter = found.parameters.front();
    const auto low = TwinValue(plant, found.cause, parameter.low, truth);
    const auto high = TwinValue(plant, found.cause, parameter.high, truth);
    if (!low || !high) return;
    const double value = truth.values[0];
    ++outcome.parameters;
    outcome.covered += std::min(*low, *high) <= value && value <= std::max(*low, *high);
    return;
  }
  const Eigen::VectorXd values = Normalised(truth);
  const bool turned = IsTurned(found.cause);
  const Eigen::VectorXd shifts = Normalised(found.cause) - found.cause.values;
  for (std::size_t i = 0; i < found.parameters.size(); ++i) {
    CauseParameter parameter = found.parameters[i];
    const auto place = static_cast<Eigen::Index>(i);
    const Role role = found.cause.effect->parameters()[i].role;
    ++outcome.parameters;
    if (turned && role == Role::kAmplitude) {
      parameter.value = -parameter.value;
      std::swap(parameter.low, parameter.high);
      parameter.low = -parameter.low;
      parameter.high = -parameter.high;
    }
    const double shift = role == Role::kPhase ? shifts[place] : 0.0;
    outcome.covered += Covers(parameter, role, values[place], shift);
  }
}

/// The worst sensor's.
double UnseenRatio(const Machine& machine, const HiddenCase& hidden,
                   const Discovery& answer) {
  const std::vector<double> ratios = UnseenRatios(machine, ChangesOfAnswer(answer),
                                                  hidden.unseen, hidden.unseen_clean);
  return ratios.empty() ? std::numeric_limits<double>::infinity()
                        : std::ranges::max(ratios);
}

}  // namespace

std::vector<std::string> TypesOfRun(int run, int causes) {
  std::vector<const Effect*> drawn = Effects();
  std::erase_if(drawn, [](const Effect* effect) { return effect->odds() == kLearned; });
  const int size = static_cast<int>(drawn.size());
  std::vector<std::string> types;
  // A second effect is another type, and another pair every time round.
  for (int i = 0; i < causes; ++i) {
    const int number = (run + i * (7 + run / size)) % size;
    types.push_back(drawn[static_cast<std::size_t>(number)]->name());
  }
  return types;
}

bool Names(const FoundCause& found, const Cause& truth) {
  return Indistinguishable(found.cause, truth);
}

namespace {

/// Whether the answer says of a cause it names that the record does not tell it from
/// this one.
bool IsAlternative(const FoundCause& found, const Cause& truth) {
  constexpr double kCompetes = 0.05;
  return std::ranges::any_of(found.alternatives, [&](const Alternative& other) {
    return other.probability >= kCompetes && Indistinguishable(other.cause, truth);
  });
}

}  // namespace

HiddenOutcome RunHidden(const Machine& machine, const std::vector<std::string>& types,
                        std::uint64_t seed) {
  HiddenOutcome outcome;
  const std::vector<Cause> truth = DrawEffects(machine, types, {}, seed);
  outcome.hidden = MakeCase(machine, truth, seed);
  DiscoverOptions options;
  options.figures = false;
  outcome.answer = Discover(machine, outcome.hidden.record, nullptr, options);
  for (const Cause& cause : truth) {
    outcome.considered +=
        std::ranges::any_of(outcome.answer.causes, [&](const FoundCause& f) {
          return Names(f, cause) || IsAlternative(f, cause);
        });
    const auto found = std::ranges::find_if(
        outcome.answer.causes, [&](const FoundCause& f) { return Names(f, cause); });
    if (found == outcome.answer.causes.end()) continue;
    ++outcome.named;
    CountParameters(machine.plant(), *found, cause, outcome);
  }
  outcome.claim = outcome.answer.verdict != DiscoveryVerdict::kNoDiscrepancy;
  outcome.right = outcome.named == static_cast<int>(truth.size()) &&
                  outcome.answer.causes.size() == truth.size() &&
                  outcome.claim == !truth.empty();
  outcome.undecided = !outcome.right &&
                      outcome.considered == static_cast<int>(truth.size()) &&
                      outcome.answer.causes.size() == truth.size();
  outcome.unseen_ratio = UnseenRatio(machine, outcome.hidden, outcome.answer);
  outcome.hidden.record = {};
  outcome.hidden.unseen = {};
  outcome.hidden.unseen_clean = {};
  return outcome;
}

}  // namespace mjdiag
