#include "mjdiag/report/discovery_json.h"

#include <cmath>
#include <utility>

#include "mjdiag/discovery/explanations.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/report/kinds_text.h"

namespace mjdiag {
namespace {

using nlohmann::json;

json Finite(double value) { return std::isfinite(value) ? json(value) : json(); }

json TextOrNull(const std::string& text) { return text.empty() ? json() : json(text); }

json Finite(const std::map<std::string, double>& values) {
  json object = json::object();
  for (const auto& [name, value] : values) object[name] = Finite(value);
  return object;
}

json ParametersOf(const FoundCause& found) {
  json parameters = json::object();
  for (const CauseParameter& parameter : found.parameters) {
    parameters[parameter.name] = {
        {"value", Finite(parameter.value)},
        {"unit", parameter.unit},
        {"sd", Finite(parameter.sd)},
        {"ci95", {Finite(parameter.low), Finite(parameter.high)}}};
  }
  return parameters;
}

json IdentityOf(const Cause& cause) {
  return {{"effect", cause.name()},
          {"site", cause.site},
          {"fault", cause.effect->IsFault()}};
}

json DecisionsOf(const Discovery& discovery) {
  json decisions = json::array();
  for (const Decision& one : discovery.decisions) {
    decisions.push_back(
        {{"tried", one.tried}, {"score", Finite(one.score)}, {"why", one.why}});
  }
  return decisions;
}

json NumbersInsteadOf(const FoundCause& found) {
  json numbers = json::array();
  for (const FoundCause::NumberInstead& one : found.numbers) {
    numbers.push_back({{"name", one.name}, {"probability", Finite(one.probability)}});
  }
  return numbers;
}

json AlternativesOf(const FoundCause& found) {
  json alternatives = json::array();
  for (const Alternative& alternative : found.alternatives) {
    json one = IdentityOf(alternative.cause);
    one["probability"] = Finite(alternative.probability);
    one["indistinguishable"] = alternative.indistinguishable;
    alternatives.push_back(std::move(one));
  }
  return alternatives;
}

json CausesOf(const Discovery& discovery) {
  json causes = json::array();
  for (const FoundCause& found : discovery.causes) {
    json cause = IdentityOf(found.cause);
    cause["parameters"] = ParametersOf(found);
    cause["probability"] = Finite(found.probability);
    cause["alternatives"] = AlternativesOf(found);
    cause["numbers_instead"] = NumbersInsteadOf(found);
    cause["nothing_instead"] = Finite(found.none);
    cause["unnamed"] = TextOrNull(found.unnamed);
    causes.push_back(std::move(cause));
  }
  return causes;
}

json ExplanationList(const Discovery& discovery) {
  json explanations = json::array();
  for (const CauseSet& explanation : ExplanationsOf(discovery.causes)) {
    json causes = json::array();
    for (const Cause& cause : explanation.causes) causes.push_back(IdentityOf(cause));
    explanations.push_back(
        {{"probability", Finite(explanation.probability)}, {"causes", causes}});
  }
  return explanations;
}

json CalibrationOf(const Discovery& discovery) {
  json numbers = json::array();
  for (const CalibratedNumber& number : discovery.calibration) {
    const auto value = [&](double factor) {
      return Finite(number.shift > 0.0 ? number.shift * std::log(factor) : factor);
    };
    numbers.push_back(
        {{"name", number.name},
         {"value", value(number.factor)},
         {"ci95", {value(number.low), value(number.high)}},
         {"prior_sd",
          Finite(number.shift > 0.0 ? number.shift * number.doubt : number.doubt)},
         {"unit", number.shift > 0.0 ? number.shift_unit : "1"},
         {"off", IsOff(number)}});
  }
  return numbers;
}

json MomentsOf(const Discovery& discovery) {
  json moments = json::array();
  for (const CalibratedMoment& moment : discovery.moments) {
    moments.push_back({{"joint", moment.joint},
                       {"axis", moment.axis},
                       {"unit", "kg m"},
                       {"model", Finite(moment.model)},
                       {"value", Finite(moment.value)},
                       {"ci95", {Finite(moment.low), Finite(moment.high)}},
                       {"prior_sd", Finite(moment.doubt)},
                       {"off", IsMoved(moment)}});
  }
  return moments;
}

json FiguresOf(const Discovery::Figures& figures) {
  return {{"train", Finite(figures.train)}, {"validation", Finite(figures.validation)}};
}

json DerivedOf(const Comparison& comparison) {
  json derived = json::object();
  for (const DerivedMismatch& signal : comparison.derived) {
    derived[signal.name] = Finite(signal.relative_error_percent);
  }
  return derived;
}

json KindsOf(const Discovery& discovery) {
  json kinds = json::array();
  for (const FoundKind& found : discovery.kinds) {
    kinds.push_back({{"kind", KindName(found.kind)},
                     {"site", found.site},
                     {"probability", Finite(found.probability)},
                     {"share", Finite(found.share)},
                     {"words", KindAt(found) + ", " + KindMeaning(found.kind) + ": " +
                                   SureText(found.probability)}});
  }
  return kinds;
}

/// Of the first record that fits saw, and the first that they did not.
json DerivedOf(const Discovery& discovery, const Comparison RecordReplay::*model) {
  const auto of = [&](const RecordReplay* replay) {
    return replay != nullptr ? DerivedOf(replay->*model) : json();
  };
  return {{"record", of(discovery.Fitted())}, {"validation", of(discovery.Unseen())}};
}

json ReplayOf(const Comparison& comparison) {
  json channels = json::object();
  for (const ChannelMismatch& channel : comparison.channels) {
    channels[channel.name] = {{"rms", Finite(channel.rms)},
                              {"mae", Finite(channel.mae)},
                              {"fit_percent", Finite(channel.fit_percent)}};
  }
  return channels;
}

json RecordsOf(const Discovery& discovery) {
  json records = json::array();
  for (const RecordReplay& replay : discovery.records) {
    records.push_back({{"file", replay.name},
                       {"role", replay.seen ? "fit" : "validation"},
                       {"before", ReplayOf(replay.before)},
                       {"replay", ReplayOf(replay.after)}});
  }
  return records;
}

Eigen::Index SamplesOf(const Discovery& discovery) {
  const RecordReplay* first = discovery.Fitted();
  return first != nullptr ? first->before.measured.samples() : 0;
}

json UnexplainedOf(const Discovery& discovery) {
  if (!discovery.unexplained) return {{"signature", nullptr}};
  const ResidualDependence& signature = *discovery.unexplained;
  return {{"signature", TextOrNull(signature.text)},
          {"site", TextOrNull(discovery.unexplained_site)},
          {"variable", TextOrNull(signature.variable)},
          {"unit", TextOrNull(signature.unit)},
          {"factor", TextOrNull(signature.factor)},
          {"shape", TextOrNull(signature.shape)},
          {"explained_share", Finite(signature.explained_share)},
          {"period", Finite(signature.period)},
          {"exponent", Finite(signature.exponent)},
          {"runner_up", TextOrNull(signature.runner_up)},
          {"runner_up_share", Finite(signature.runner_up_share)}};
}

json LadderOf(const Discovery& discovery) {
  json ladder = json::array();
  for (const LadderStep& step : discovery.ladder) {
    ladder.push_back({{"added", step.added},
                      {"train", Finite(step.train)},
                      {"held_out", Finite(step.held_out)},
                      {"error_percent", Finite(step.error_percent)},
                      {"validation_percent", Finite(step.validation_percent)}});
  }
  return ladder;
}

json MinimumDetectableFaultsOf(const Discovery& discovery) {
  json limits = json::array();
  for (const FaultLimit& limit : discovery.fault_limits) {
    limits.push_back({{"fault", limit.fault},
                      {"before", Finite(limit.before)},
                      {"after", Finite(limit.after)}});
  }
  return limits;
}

}  // namespace

json ToJson(const Discovery& discovery, const std::string& extended_plant) {
  return {{"schema", "mjdiag.discovery/1"},
          {"setup", discovery.setup},
          {"verdict", VerdictName(discovery.verdict)},
          {"force_left", discovery.force_left ? Finite(*discovery.force_left) : json()},
          {"kinds", KindsOf(discovery)},
          {"causes", CausesOf(discovery)},
          {"explanations", ExplanationList(discovery)},
          {"calibration", CalibrationOf(discovery)},
          {"moments", MomentsOf(discovery)},
          {"mismatch",
           {{"before", FiguresOf(discovery.mismatch_before)},
            {"after", FiguresOf(discovery.mismatch_after)}}},
          {"horizon", Finite(discovery.horizon)},
          {"noise_floor", Finite(discovery.noise_floor)},
          {"units", discovery.unit},
          {"gain",
           {{"train", Finite(discovery.gain_train)},
            {"validation", Finite(discovery.gain_validation)}}},
          {"whiteness",
           {{"before", Finite(1.0 - discovery.colour_before)},
            {"after", Finite(1.0 - discovery.colour_after)}}},
          {"extended_plant", TextOrNull(extended_plant)},
          {"unexplained", UnexplainedOf(discovery)},
          {"train_share", Finite(discovery.train_share)},
          {"sample_time", Finite(discovery.sample_time)},
          {"substeps", discovery.substeps},
          {"samples", SamplesOf(discovery)},
          {"derived",
           {{"before", DerivedOf(discovery, &RecordReplay::before)},
            {"after", DerivedOf(discovery, &RecordReplay::after)}}},
          {"records", RecordsOf(discovery)},
          {"ladder", LadderOf(discovery)},
          {"fault_limits", MinimumDetectableFaultsOf(discovery)},
          {"budget",
           {{"used", Finite(discovery.budget.used)},
            {"limit", Finite(discovery.budget.limit)},
            {"stopped", discovery.budget.stopped},
            {"left_out", discovery.budget.left_out}}},
          {"decisions", DecisionsOf(discovery)},
          {"notes", discovery.notes}};
}

}  // namespace mjdiag
