#include "mjdiag/discovery/checks/clock_drift.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "mjdiag/discovery/checks/fitted_run.h"
#include "mjdiag/discovery/checks/lag_trend.h"
#include "mjdiag/discovery/checks/nominal_run.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Two channels whose clocks are held against each other.
struct ClockPair {
  std::string reading;
  std::string other;  ///< channel whose lag is held against it; empty: none has any
  std::string other_words;
  std::vector<std::string> acting;  ///< channels that act on the machine
};

std::string InQuotes(const std::string& name) { return "'" + name + "'"; }

std::vector<ClockPair> ClockPairsOf(const Setup& setup) {
  std::vector<ClockPair> pairs;
  if (setup.control.axes.empty()) {
    std::vector<std::string> inputs;
    for (const ActuatorSetup& actuator : setup.channels.actuators) {
      inputs.push_back(actuator.channel);
    }
    const std::string words =
        inputs.size() == 1 ? InQuotes(inputs.front()) : "the inputs";
    for (const SensorSetup& sensor : setup.channels.sensors) {
      pairs.push_back({sensor.channel, "", words, inputs});
    }
    return pairs;
  }
  for (const AxisSetup& axis : setup.control.axes) {
    const std::string reference = axis.name + "_ref";
    const std::vector<std::string> acting{reference, axis.actuator};
    pairs.push_back({axis.sensor, axis.actuator, InQuotes(axis.actuator), acting});
    // An input that the model gets too wrong leaves the reference as the other clock.
    pairs.push_back({axis.sensor, "", InQuotes(reference), acting});
  }
  return pairs;
}

class ClockCheck {
 public:
  ClockCheck(const Machine& machine, const Record& measured, const Record& simulated)
      : machine_(machine), measured_(measured), simulated_(simulated) {}

  std::vector<std::string> Check() {
    for (const ClockPair& pair : ClockPairsOf(machine_.setup())) Compare(pair);
    return std::move(notes_);
  }

 private:
  VectorXd Counted(const Record& record, const std::string& channel) const {
    return CountedSamples(machine_.setup(), record, channel);
  }

  LagWindows WindowsOf(const ClockPair& pair) const {
    LagWindows windows{};
    for (const std::string& channel : pair.acting) {
      const LagWindows active = ActiveWindows(Counted(measured_, channel));
      for (std::size_t w = 0; w < windows.size(); ++w) windows[w] |= active[w];
    }
    return windows;
  }

  /// Drift behind a simulated record [samples]; 0: none that counts, nothing: it cannot be
  /// told.
  std::optional<double> DriftOf(const ClockPair& pair, const Record& simulated,
                                const LagWindows& windows) const {
    const auto trend = [&](const std::string& channel) {
      return FindLagTrend(Counted(measured_, channel), Counted(simulated, channel),
                          windows);
    };
    const std::optional<LagTrend> reading = trend(pair.reading);
    if (!reading) return std::nullopt;
    if (pair.other.empty()) return ClockDrift(*reading, LagTrend{});
    const std::optional<LagTrend> other = trend(pair.other);
    if (!other) return std::nullopt;
    return ClockDrift(*reading, *other);
  }

  void Compare(const ClockPair& pair) {
    LagWindows all{};
    all.fill(true);
    const double drift = DriftOf(pair, simulated_, all).value_or(0.0);
    if (drift == 0.0) return;
    const LagWindows acting = WindowsOf(pair);
    const std::optional<double> while_acting = DriftOf(pair, simulated_, acting);
    if (!while_acting) {
      notes_.push_back(
          "whether the clocks of " + InQuotes(pair.reading) + " and " +
          pair.other_words + " drift is not checked: by " + Samples(drift) +
          " over the record, or a frequency is off, and nothing acts on the "
          "machine for long enough to tell");
      return;
    }
    if (*while_acting == 0.0) return;
    if (!fitted_) fitted_ = FittedRun(machine_, measured_, simulated_);
    const double left = DriftOf(pair, *fitted_, acting).value_or(0.0);
    if (left == 0.0) return;
    throw InputError("record",
                     "clocks of " + InQuotes(pair.reading) + " and " +
                         pair.other_words + " drift by " + Samples(left) +
                         " over the record",
                     "channels that are sampled together");
  }

  static std::string Samples(double drift) {
    char size[48];
    std::snprintf(size, sizeof size, "%.1f samples", std::abs(drift));
    return size;
  }

  const Machine& machine_;
  const Record& measured_;
  const Record& simulated_;
  std::optional<Record> fitted_;
  std::vector<std::string> notes_;
};

}  // namespace

std::vector<std::string> CheckClocks(const Machine& machine, const Record& measured,
                                     const Record& simulated) {
  return ClockCheck(machine, measured, simulated).Check();
}

}  // namespace mjdiag
