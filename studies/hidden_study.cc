#include "mjdiag/studies/hidden_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// Amplitude >= 0, as a sine of a negative one is a sine of another phase.
void Normalise(std::map<std::string, double>& values) {
  const auto amplitude = values.find("amplitude");
  if (amplitude == values.end() || amplitude->second >= 0.0) return;
  amplitude->second = -amplitude->second;
  values.at("phase") += std::numbers::pi;
}

/// Whether a true value lies in the interval, an end of which may be missing; one
/// without both says nothing and covers nothing. Phases up to whole turns.
bool Covers(const CauseParameter& parameter, double truth, double shift) {
  double off = truth - (parameter.value + shift);
  if (parameter.name == "phase") off = std::remainder(off, 2.0 * std::numbers::pi);
  return (std::isfinite(parameter.low) || std::isfinite(parameter.high)) &&
         off >= parameter.low - parameter.value &&
         off <= parameter.high - parameter.value;
}

/// The value of that kind which is the same change of the model; none if none is.
std::optional<double> TwinValue(const mjModel& plant, Cause cause, double value,
                                const Cause& kind) {
  cause.spec.parameters.begin()->second = value;
  for (const Cause& twin : Twins(plant, cause)) {
    if (SameKind(twin, kind)) return twin.spec.parameters.begin()->second;
  }
  return std::nullopt;
}

void CountParameters(const mjModel& plant, const FoundCause& found, const Cause& truth,
                     HiddenOutcome& outcome) {
  if (!SameKind(found.cause, truth)) {
    // A knob for an effect or the other way round: the interval of the twin is that of
    // the one found.
    const CauseParameter& parameter = found.parameters.front();
    const auto low = TwinValue(plant, found.cause, parameter.low, truth);
    const auto high = TwinValue(plant, found.cause, parameter.high, truth);
    if (!low || !high) return;
    const double value = truth.spec.parameters.begin()->second;
    ++outcome.parameters;
    outcome.covered += std::min(*low, *high) <= value && value <= std::max(*low, *high);
    return;
  }
  std::map<std::string, double> values = truth.spec.parameters;
  std::map<std::string, double> fitted = found.cause.spec.parameters;
  Normalise(values);
  const double phase_before = fitted.contains("phase") ? fitted.at("phase") : 0.0;
  const bool turned = fitted.contains("amplitude") && fitted.at("amplitude") < 0.0;
  Normalise(fitted);
  for (CauseParameter parameter : found.parameters) {
    ++outcome.parameters;
    double shift = 0.0;
    if (turned && parameter.name == "phase") shift = fitted.at("phase") - phase_before;
    if (turned && parameter.name == "amplitude") {
      parameter.value = -parameter.value;
      std::swap(parameter.low, parameter.high);
      parameter.low = -parameter.low;
      parameter.high = -parameter.high;
    }
    outcome.covered += Covers(parameter, values.at(parameter.name), shift);
  }
}

double UnseenRatio(const Machine& machine, const HiddenCase& hidden,
                   const Discovery& answer) {
  const Changes changes = ChangesOf(answer);
  RunOptions options;
  options.noise_scale = 0.0;
  Record simulated;
  try {
    simulated = Simulate(machine.With(changes), Replay(machine.setup(), hidden.unseen),
                         options);
  } catch (const NumericalError&) {
    return std::numeric_limits<double>::infinity();
  }
  double worst = 0.0;
  for (const SensorSetup& sensor : machine.channels().sensors) {
    const Eigen::VectorXd& measured = hidden.unseen.At(sensor.channel).samples;
    const double floor = Rms(measured - hidden.unseen_clean.At(sensor.channel).samples);
    worst =
        std::max(worst, Rms(measured - simulated.At(sensor.channel).samples) / floor);
  }
  return worst;
}

}  // namespace

std::vector<std::string> TypesOfRun(int run, int causes) {
  const auto& catalogue = EffectCatalogue();
  const int size = static_cast<int>(catalogue.size());
  std::vector<std::string> types;
  // A second effect is another type, and another pair every time round.
  for (int i = 0; i < causes; ++i) {
    const int number = (run + i * (7 + run / size)) % size;
    types.push_back(catalogue[static_cast<std::size_t>(number)].name);
  }
  return types;
}

bool Names(const mjModel& plant, const FoundCause& found, const Cause& truth) {
  return Indistinguishable(plant, found.cause, truth);
}

namespace {

/// Whether the answer says of a cause it names that the record does not tell it from
/// this one.
bool IsAlternative(const mjModel& plant, const FoundCause& found, const Cause& truth) {
  constexpr double kCompetes = 0.05;
  return std::ranges::any_of(found.alternatives, [&](const Alternative& other) {
    return other.probability >= kCompetes &&
           Indistinguishable(plant, other.cause, truth);
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
          return Names(machine.plant(), f, cause) ||
                 IsAlternative(machine.plant(), f, cause);
        });
    const auto found = std::ranges::find_if(
        outcome.answer.causes,
        [&](const FoundCause& f) { return Names(machine.plant(), f, cause); });
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
