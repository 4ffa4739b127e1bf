#include "mjdiag/comparison/replay_error.h"

#include <limits>
#include <vector>

#include "mjdiag/comparison/derived.h"
#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

std::vector<std::string> Positions(const Setup& setup, const Record& measured) {
  std::vector<std::string> positions;
  for (const SensorSetup& sensor : setup.sensors) {
    const bool position = sensor.unit == "m" || sensor.unit == "rad";
    if (position && measured.Find(sensor.channel)) positions.push_back(sensor.channel);
  }
  return positions;
}

}  // namespace

std::map<std::string, double> ReplayErrors(const Setup& setup, const mjModel& plant,
                                           const Changes& changes,
                                           const Record& measured) {
  RunOptions options;
  options.faults = changes.faults;
  options.effects = changes.effects;
  options.noise_scale = 0.0;
  Record simulated;
  try {
    simulated = Simulate(setup, plant, Replay(setup, measured), options);
  } catch (const NumericalError&) {
    return {{setup.sensors.front().channel, std::numeric_limits<double>::infinity()}};
  }
  std::map<std::string, double> errors;
  const auto add = [&](const std::string& channel) {
    const Channel* before = measured.Find(channel);
    if (before == nullptr) return;
    errors[channel] = RelativeErrorPercent(
        before->samples, simulated.At(channel).samples, setup.compare.skip_samples);
  };
  for (const SensorSetup& sensor : setup.sensors) add(sensor.channel);
  if (!setup.axes.empty()) {
    for (const ActuatorSetup& actuator : setup.actuators) add(actuator.channel);
  }
  const std::vector<std::string> positions = Positions(setup, measured);
  const Record derived = DeriveChannels(measured, positions, setup.compare);
  for (const DerivedMismatch& signal :
       MeasureDerived(derived, DeriveChannels(simulated, positions, setup.compare),
                      setup.compare.skip_samples)) {
    errors[signal.name] = signal.relative_error_percent;
  }
  return errors;
}

}  // namespace mjdiag
