#include "mjdiag/watch/live_state.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

/// JSON has no NaN.
nlohmann::json Finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json FaultsJson(const Finding& look,
                          const std::vector<FaultMeaning>& meanings) {
  nlohmann::json faults = nlohmann::json::array();
  for (std::size_t i = 0; i < look.result.faults.size(); ++i) {
    const FaultVerdict& fault = look.result.faults[i];
    faults.push_back({{"name", fault.name},
                      {"meaning", meanings[i].meaning},
                      {"healthy", meanings[i].healthy},
                      {"value", Finite(fault.value)},
                      {"sd", Finite(fault.sd)},
                      {"ci95", {Finite(fault.ci95.min), Finite(fault.ci95.max)}},
                      {"detected", fault.detected}});
  }
  return faults;
}

nlohmann::json DisturbanceJson(const Finding& look) {
  const DisturbanceReport& report = look.result.disturbance;
  nlohmann::json tones = nlohmann::json::array();
  for (const DisturbanceTone& tone : report.tones) {
    tones.push_back({{"frequency", tone.frequency},
                     {"psd", tone.psd},
                     {"threshold", tone.threshold},
                     {"amplitude", tone.amplitude}});
  }
  return {{"analysed", look.analysed},
          {"tones", tones},
          {"total", Finite(report.total)},
          {"total_threshold", Finite(report.total_threshold)},
          {"noise_ratio", Finite(report.noise_ratio)},
          {"noise_raised", report.noise_raised}};
}

nlohmann::json SourceJson(const SourceReport& source) {
  return {{"name", source.name},
          {"state", NameOf(source.state)},
          {"since", source.since},
          {"last_tick", source.last_tick},
          {"packets", source.packets},
          {"bytes", source.bytes},
          {"ticks", source.ticks},
          {"taken", source.order.taken},
          {"missing", source.order.missing},
          {"gaps", source.order.gaps},
          {"repeated", source.order.repeated},
          {"reordered", source.order.reordered},
          {"late", source.order.late},
          {"foreign", source.order.foreign},
          {"nonsense", source.nonsense},
          {"last_nonsense", source.last_nonsense},
          {"no_room", source.no_room},
          {"kernel", source.kernel},
          {"sender_runs", source.order.runs},
          {"diagnosis_runs", source.runs},
          {"clock",
           {{"sent_rate", Finite(source.clock.sent_rate)},
            {"arrived_rate", Finite(source.clock.arrived_rate)},
            {"offset", Finite(source.clock.offset)},
            {"steps", source.clock.steps}}},
          {"notes", source.notes}};
}

}  // namespace

const char* NameOf(SourceState state) {
  switch (state) {
    case SourceState::kWaiting:
      return "waiting";
    case SourceState::kRunning:
      return "running";
    case SourceState::kSilent:
      return "silent";
    case SourceState::kOtherRate:
      return "other_rate";
  }
  return "";
}

nlohmann::json ToJson(const std::deque<LiveEvent>& events) {
  nlohmann::json json = nlohmann::json::array();
  for (const LiveEvent& event : events) {
    json.push_back(
        {{"time", event.time}, {"kind", event.kind}, {"words", event.words}});
  }
  return json;
}

nlohmann::json ToJson(const LiveState& state, const std::vector<FaultMeaning>& faults) {
  nlohmann::json json = {{"schema", "mjdiag.watch/1"},
                         {"setup", state.setup},
                         {"started", state.started},
                         {"now", state.now},
                         {"verdict", ToJson(state.verdict)},
                         {"source", SourceJson(state.source)},
                         {"load",
                          {{"share", state.load.share},
                           {"deepest", state.load.deepest},
                           {"room", state.load.room}}},
                         {"events", ToJson(state.events)},
                         {"picture", state.picture},
                         {"look", nullptr}};
  if (!state.looked) return json;
  const Finding& look = state.look;
  json["look"] = {
      {"time", look.time},
      {"run_time", look.run_time},
      {"kind", NameOf(look.kind)},
      {"words", look.words},
      {"residual",
       {{"min", Finite(look.residual.least)},
        {"max", Finite(look.residual.most)},
        {"limits", {Finite(look.result.limits.min), Finite(look.result.limits.max)}},
        {"alarm", look.residual_alarm},
        {"integral", Finite(look.integral)},
        {"lasting", look.lasting_alarm}}},
      {"misfit", Finite(look.result.nis)},
      {"by_twin", look.result.by_twin},
      {"faults", FaultsJson(look, faults)},
      {"disturbance", DisturbanceJson(look)}};
  return json;
}

}  // namespace mjdiag
