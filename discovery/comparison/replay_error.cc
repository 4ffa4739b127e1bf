#include "mjdiag/discovery/comparison/replay_error.h"

#include <limits>
#include <vector>

#include "mjdiag/discovery/comparison/derived.h"
#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

std::vector<std::string> MeasuredPositions(const Setup& setup, const Record& measured) {
  std::vector<std::string> positions;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    const bool position = sensor.unit == "m" || sensor.unit == "rad";
    if (position && measured.Find(sensor.channel)) positions.push_back(sensor.channel);
  }
  return positions;
}

}  // namespace

std::map<std::string, double> ReplayErrors(const Machine& machine,
                                           const Record& measured) {
  RunOptions options;
  options.noise_scale = 0.0;
  Record simulated;
  try {
    simulated = Simulate(machine, Replay(machine.setup(), measured), options);
  } catch (const NumericalError&) {
    return {{machine.channels().sensors.front().channel,
             std::numeric_limits<double>::infinity()}};
  }
  std::map<std::string, double> errors;
  const auto add = [&](const std::string& channel) {
    const Channel* before = measured.Find(channel);
    if (before == nullptr) return;
    errors[channel] = RelativeErrorPercent(*before, simulated.At(channel),
                                           machine.setup().compare.skip_samples);
  };
  for (const SensorSetup& sensor : machine.channels().sensors) add(sensor.channel);
  if (!machine.setup().control.axes.empty()) {
    for (const ActuatorSetup& actuator : machine.channels().actuators)
      add(actuator.channel);
  }
  const std::vector<std::string> positions =
      MeasuredPositions(machine.setup(), measured);
  const Record derived = DeriveChannels(measured, positions, machine.setup().compare);
  for (const DerivedMismatch& signal : MeasureDerived(
           derived, DeriveChannels(simulated, positions, machine.setup().compare),
           machine.setup().compare.skip_samples)) {
    errors[signal.name] = signal.relative_error_percent;
  }
  return errors;
}

}  // namespace mjdiag
