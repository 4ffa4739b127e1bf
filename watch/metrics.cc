// Metrics of live_state.h: the text format of Prometheus, version 0.0.4.

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>

#include "mjdiag/watch/live_state.h"

namespace mjdiag {
namespace {

constexpr std::array kSaid = {VerdictKind::kHealthy,     VerdictKind::kFault,
                              VerdictKind::kUnexplained, VerdictKind::kDisturbance,
                              VerdictKind::kNoise,       VerdictKind::kResidual};
constexpr std::array kStates = {SourceState::kWaiting, SourceState::kRunning,
                                SourceState::kSilent, SourceState::kOtherRate};

std::string NumberText(double value) {
  if (std::isnan(value)) return "NaN";
  std::array<char, 40> digits{};
  std::snprintf(digits.data(), digits.size(), "%.17g", value);
  return digits.data();
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

class MetricText {
 public:
  void Describe(const std::string& name, const char* type, const char* help) {
    text_ += "# HELP mjdiag_watch_" + name + " " + help + "\n# TYPE mjdiag_watch_" +
             name + " " + type + "\n";
  }
  void Add(const std::string& name, double value) {
    text_ += "mjdiag_watch_" + name + " " + NumberText(value) + "\n";
  }
  void Add(const std::string& name, const std::string& label, const std::string& of,
           double value) {
    text_ += "mjdiag_watch_" + name + "{" + label + "=\"" + Escaped(of) + "\"} " +
             NumberText(value) + "\n";
  }
  void One(const std::string& name, const char* type, const char* help, double value) {
    Describe(name, type, help);
    Add(name, value);
  }
  std::string& text() { return text_; }

 private:
  std::string text_;
};

void AddSource(const SourceReport& source, MetricText& metrics) {
  const auto count = [&](const char* name, const char* help, std::int64_t value) {
    metrics.One(name, "counter", help, static_cast<double>(value));
  };
  metrics.Describe("source_state", "gauge", "1 for the state that the source is in.");
  for (const SourceState state : kStates) {
    metrics.Add("source_state", "state", NameOf(state), source.state == state ? 1 : 0);
  }
  metrics.One("last_tick_timestamp_seconds", "gauge",
              "When the last tick came in; 0: none has.", source.last_tick);
  count("bytes_total", "Bytes that came in.", source.bytes);
  count("packets_total", "Packets, messages and lines that were ticks.",
        source.packets);
  count("ticks_total", "Ticks that were judged.", source.order.taken);
  count("ticks_missing_total", "Ticks that never came, or too late.",
        source.order.missing);
  count("gaps_total", "Stretches of missing ticks.", source.order.gaps);
  count("ticks_repeated_total", "Ticks that came again.", source.order.repeated);
  count("ticks_reordered_total", "Ticks that came out of order, in time.",
        source.order.reordered);
  count("ticks_late_total", "Missing ticks that came when they were given up.",
        source.order.late);
  count("ticks_foreign_total", "Ticks of another sender.", source.order.foreign);
  count("nonsense_total", "Packets and lines that are no ticks.", source.nonsense);
  count("ticks_no_room_total", "Ticks lost because the diagnosis was behind.",
        source.no_room);
  count("datagrams_dropped_total", "Datagrams that the system dropped.", source.kernel);
  count("sender_runs_total", "Times that the sender began.", source.order.runs);
  count("diagnosis_runs_total", "Times that the diagnosis began.", source.runs);
  metrics.One("clock_rate", "gauge",
              "Clock of the sender over the count of its ticks, less 1.",
              source.clock.sent_rate);
  metrics.One("clock_offset_seconds", "gauge", "Clock of the sender less ours.",
              source.clock.offset);
}

void AddLook(const Finding& look, MetricText& metrics) {
  metrics.Describe("residual", "gauge",
                   "Residual since the look before, in units of its noise.");
  metrics.Add("residual", "of", "min", look.residual.least);
  metrics.Add("residual", "of", "max", look.residual.most);
  metrics.Describe("residual_limit", "gauge", "Limits of the residual.");
  metrics.Add("residual_limit", "of", "min", look.result.limits.min);
  metrics.Add("residual_limit", "of", "max", look.result.limits.max);
  metrics.One("residual_integral", "gauge", "Mean magnitude of the residual.",
              look.integral);
  metrics.One("misfit", "gauge",
              "Squared innovations of the twin over what is expected of them.",
              look.result.nis);
  metrics.Describe("fault_value", "gauge", "Estimated value of a fault parameter.");
  for (const FaultVerdict& fault : look.result.faults) {
    metrics.Add("fault_value", "fault", fault.name, fault.value);
  }
  metrics.Describe("fault_sd", "gauge", "Its standard deviation.");
  for (const FaultVerdict& fault : look.result.faults) {
    metrics.Add("fault_sd", "fault", fault.name, fault.sd);
  }
  metrics.Describe("fault_detected", "gauge", "1 where the fault is named.");
  for (const FaultVerdict& fault : look.result.faults) {
    metrics.Add("fault_detected", "fault", fault.name, fault.detected ? 1 : 0);
  }
  metrics.One("tones", "gauge", "Tones in the disturbance residual.",
              static_cast<double>(look.result.disturbance.tones.size()));
  metrics.One("noise_ratio", "gauge", "Noise of the sensors over what is usual.",
              look.analysed ? look.result.disturbance.noise_ratio : std::nan(""));
}

/// Resident memory of this process [bytes], NaN where /proc does not say.
double ResidentBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmRSS:" && status >> kilobytes) return 1024.0 * kilobytes;
  }
  return std::nan("");
}

}  // namespace

std::string Metrics(const LiveState& state) {
  MetricText metrics;
  metrics.Describe("verdict", "gauge", "1 for the verdict that is said.");
  for (const VerdictKind kind : kSaid) {
    metrics.Add("verdict", "kind", NameOf(kind), state.verdict.kind == kind ? 1 : 0);
  }
  metrics.One("verdict_since_timestamp_seconds", "gauge", "Since when it is said.",
              state.verdict.since);
  AddSource(state.source, metrics);
  if (state.looked) AddLook(state.look, metrics);
  metrics.One("load", "gauge", "Share of a core that the diagnosis takes.",
              state.load.share);
  metrics.One("queue_deepest", "gauge", "Ticks that have waited, at most.",
              static_cast<double>(state.load.deepest));
  // As every program of Prometheus calls them.
  metrics.text() +=
      "# HELP process_resident_memory_bytes Resident memory.\n"
      "# TYPE process_resident_memory_bytes gauge\nprocess_resident_memory_bytes " +
      NumberText(ResidentBytes()) +
      "\n# HELP process_cpu_seconds_total Processor time.\n"
      "# TYPE process_cpu_seconds_total counter\nprocess_cpu_seconds_total " +
      NumberText(static_cast<double>(std::clock()) / CLOCKS_PER_SEC) + "\n";
  return metrics.text();
}

}  // namespace mjdiag
