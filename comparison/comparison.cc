#include "mjdiag/comparison/comparison.h"

#include <algorithm>
#include <utility>

#include "mjdiag/comparison/noise_floor.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// Below this the noise of a record cannot be told from its motion.
constexpr Eigen::Index kShortestComparison = 64;

/// The channels to compare, sensors first. In open loop the actuators are the input,
/// not an answer.
std::vector<std::string> ComparedChannels(const Setup& setup) {
  std::vector<std::string> names;
  for (const SensorSetup& sensor : setup.channels.sensors)
    names.push_back(sensor.channel);
  if (setup.control.axes.empty()) return names;
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    names.push_back(actuator.channel);
  }
  return names;
}

/// Position sensors among the compared channels.
std::vector<std::string> Positions(const Record& compared, const Setup& setup) {
  std::vector<std::string> names;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    const bool position = sensor.unit == "m" || sensor.unit == "rad";
    if (position && compared.Find(sensor.channel)) names.push_back(sensor.channel);
  }
  return names;
}

Record Select(const Record& record, const std::vector<std::string>& names,
              double start_time) {
  Record selected(record.sample_time(), start_time);
  for (const std::string& name : names) selected.Add(record.At(name));
  return selected;
}

double Ratio(const ChannelMismatch& channel) {
  // 0 / 0 of a noise-free channel without mismatch ranks last.
  return channel.rms == 0.0 ? 0.0 : channel.rms / channel.noise_floor.rms;
}

void CheckUnits(const Record& measured, const Record& simulated) {
  for (const Channel& channel : measured.channels()) {
    const std::string& expected = simulated.At(channel.name).unit;
    if (channel.unit != expected) {
      throw InputError("record channel '" + channel.name + "'", "unit " + channel.unit,
                       "unit " + expected + " as in the setup");
    }
  }
}

}  // namespace

bool Comparison::exceeds_noise() const {
  return std::any_of(channels.begin(), channels.end(),
                     [](const ChannelMismatch& c) { return c.exceeds_noise; });
}

const ChannelMismatch* Comparison::Worst() const {
  const auto rank = [](const ChannelMismatch& c) {
    return std::pair(c.exceeds_noise, Ratio(c));
  };
  const auto worst =
      std::max_element(channels.begin(), channels.end(),
                       [&](const ChannelMismatch& a, const ChannelMismatch& b) {
                         return rank(a) < rank(b);
                       });
  return worst == channels.end() ? nullptr : &*worst;
}

Comparison Compare(const Machine& machine, const Record& measured,
                   const RunOptions& options) {
  Comparison result;
  result.setup = machine.setup().name;
  result.closed_loop = !machine.setup().control.axes.empty();
  result.options.skip_samples = machine.setup().compare.skip_samples;

  std::vector<std::string> names;
  for (const std::string& name : ComparedChannels(machine.setup())) {
    (measured.Find(name) ? names : result.not_measured).push_back(name);
  }
  if (names.empty()) {
    throw InputError("record", "none of the setup's sensors",
                     "a channel '" + result.not_measured.front() + "'");
  }

  const Eigen::Index samples = measured.samples() - result.options.skip_samples;
  if (samples < kShortestComparison) {
    throw InputError("record",
                     std::to_string(measured.samples()) + " samples, of which " +
                         std::to_string(result.options.skip_samples) + " are left out",
                     "at least " + std::to_string(kShortestComparison) + " to compare");
  }

  const Machine noisy =
      machine.WithSensorNoise(MeasuredNoise(machine.channels(), measured));
  const Excitation excitation = Replay(noisy.setup(), measured);
  RunOptions without_noise = options;
  without_noise.noise_scale = 0.0;
  const Record simulated = Simulate(noisy, excitation, without_noise);
  const auto floors = EstimateNoiseFloor(noisy, excitation, simulated, options,
                                         result.options.skip_samples);

  const double start = measured.start_time();
  result.measured = Select(measured, names, start);
  result.simulated = Select(simulated, names, start);
  CheckUnits(result.measured, result.simulated);
  for (const std::string& name : names) {
    result.channels.push_back(MeasureMismatch(result.measured, result.simulated, name,
                                              floors.at(name), result.options));
  }
  const std::vector<std::string> positions =
      Positions(result.measured, machine.setup());
  result.measured_derived =
      DeriveChannels(result.measured, positions, machine.setup().compare);
  result.simulated_derived =
      DeriveChannels(result.simulated, positions, machine.setup().compare);
  result.derived = MeasureDerived(result.measured_derived, result.simulated_derived,
                                  result.options.skip_samples);
  return result;
}

}  // namespace mjdiag
