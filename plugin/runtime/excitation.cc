#include <cmath>
#include <optional>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/setup/declared_names.h"
#include "mjdiag/plugin/setup/measured_channel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

AxisReference MeasuredReference(const Record& measured, const std::string& axis,
                                const std::string& unit) {
  const std::string channel = axis + "_ref";
  const Eigen::VectorXd& position = MeasuredChannel(measured, channel, unit).samples;
  const Channel* velocity = measured.Find(channel + "_velocity");
  const Channel* acceleration = measured.Find(channel + "_acceleration");
  const Channel* snap = measured.Find(channel + "_snap");
  if (velocity == nullptr || acceleration == nullptr || snap == nullptr) {
    return DifferentiateReference(axis, position, measured.sample_time());
  }
  return {axis, position, velocity->samples, acceleration->samples, snap->samples};
}

// A first reading within the sensor's noise of the reference says "at the reference";
// taking it at its word would start the run with a transient made of noise.
double StartReading(const SensorSetup& sensor, double measured, double reference) {
  constexpr double kSigmas = 6.0;
  const bool at_reference = std::abs(measured - reference) <= kSigmas * sensor.noise_sd;
  return at_reference ? reference : measured;
}

void CheckSampleTime(const Setup& setup, const Record& measured) {
  if (std::abs(measured.sample_time() / setup.rates.tick() - 1.0) > 1e-4) {
    throw InputError(
        "record", "sample time " + std::to_string(measured.sample_time() * 1e3) + " ms",
        "the control tick of the setup, " + std::to_string(setup.rates.tick() * 1e3) +
            " ms");
  }
}

}  // namespace

Excitation FollowTrajectory(const Setup& setup, const Trajectory& trajectory) {
  return {SampleTrajectory(trajectory, NamesOf(setup.control.axes, &AxisSetup::name),
                           setup.rates.tick()),
          {},
          {}};
}

Excitation DefaultMotion(const Setup& setup) {
  const std::string& fallback = setup.trajectories.fallback;
  if (fallback.empty()) {
    throw InputError("setup '" + setup.name + "'", "has no trajectory",
                     "one under [trajectories]");
  }
  return FollowTrajectory(setup, setup.trajectories.Find(fallback));
}

Excitation Replay(const Setup& setup, const Record& measured) {
  CheckSampleTime(setup, measured);
  Excitation excitation;
  excitation.inputs = Record(setup.rates.tick(), measured.start_time());
  for (const std::string& name : setup.channels.Switches()) {
    if (measured.Find(name) == nullptr) continue;
    excitation.inputs.Add(MeasuredChannel(measured, name, "1"));
  }
  if (setup.control.axes.empty()) {
    for (const ActuatorSetup& actuator : setup.channels.actuators) {
      excitation.inputs.Add(MeasuredChannel(measured, actuator.channel, actuator.unit));
    }
    for (const SensorSetup& sensor : setup.channels.sensors) {
      const Channel* channel = measured.Find(sensor.channel);
      if (channel == nullptr) continue;
      excitation.start[sensor.channel] = StartReading(sensor, channel->samples[0], 0.0);
    }
    return excitation;
  }
  excitation.reference.sample_time = setup.rates.tick();
  for (const AxisSetup& axis : setup.control.axes) {
    excitation.reference.axes.push_back(MeasuredReference(
        measured, axis.name, setup.channels.Sensor(axis.sensor).unit));
    excitation.start[axis.sensor] = StartReading(
        setup.channels.Sensor(axis.sensor),
        MeasuredChannel(measured, axis.sensor, setup.channels.Sensor(axis.sensor).unit)
            .samples[0],
        excitation.reference.axes.back().position[0]);
    if (const Channel* known = measured.Find(axis.known_disturbance)) {
      excitation.inputs.Add(*known);
    }
  }
  return excitation;
}

Setup WithoutControllers(Setup setup) {
  setup.control.axes.clear();
  return setup;
}

}  // namespace mjdiag
