#include "mjdiag/discovery/checks/nominal_run.h"

#include <utility>
#include <vector>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/runtime/tick_loop.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

RunOptions WithoutNoise() {
  RunOptions options;
  options.noise_scale = 0.0;
  return options;
}

}  // namespace

Record NominalRun(const Machine& machine, const Record& measured, bool from_readings) {
  Setup unlimited = machine.setup();
  for (SensorSetup& sensor : unlimited.channels.sensors) sensor.resolution = 0.0;
  for (ActuatorSetup& actuator : unlimited.channels.actuators) actuator.limit = 0.0;
  for (AxisSetup& axis : unlimited.control.axes) {
    if (axis.nested) axis.nested->saturation = 0.0;
  }
  Excitation excitation = Replay(unlimited, measured);
  if (!from_readings) excitation.start.clear();
  return Simulate(machine.WithSetup(unlimited), excitation, WithoutNoise());
}

VectorXd CommandedInput(const Setup& setup, const Record& measured,
                        const std::string& actuator) {
  TickLoop loop(setup, Replay(setup, measured), WithoutNoise());
  std::vector<const VectorXd*> readings;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    readings.push_back(&measured.At(sensor.channel).samples);
  }
  std::vector<double> outputs(readings.size());
  std::vector<double> inputs(setup.channels.actuators.size());
  for (Index k = 0; k < measured.samples(); ++k) {
    for (std::size_t i = 0; i < readings.size(); ++i) outputs[i] = (*readings[i])[k];
    loop.Tick(outputs, inputs);
  }
  return CountedSamples(setup, loop.ToRecord(), actuator);
}

VectorXd CountedSamples(const Setup& setup, const Record& record,
                        const std::string& channel) {
  const VectorXd& samples = record.At(channel).samples;
  return samples.tail(samples.size() - setup.compare.skip_samples);
}

Record WithScaled(const Record& record, const std::string& channel, double factor) {
  Record scaled(record.sample_time(), record.start_time());
  for (Channel one : record.channels()) {
    if (one.name == channel) one.samples *= factor;
    scaled.Add(std::move(one));
  }
  return scaled;
}

}  // namespace mjdiag
