#include "mjdiag/plugin/replay/record_moment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Half of the time over which a motion is a quadratic polynomial [s].
constexpr double kHalf = 0.02;
constexpr Index kFewestSamples = 3;

Index SamplesToEachSide(const Record& record) {
  return std::max(kFewestSamples,
                  static_cast<Index>(std::lround(kHalf / record.sample_time())));
}

/// Value, slope and curvature of a channel at a time, by least squares.
Vector3d SmoothAt(const Channel& channel, const Record& record, double time) {
  const double place = (time - record.start_time()) / record.sample_time();
  const auto at = static_cast<Index>(std::lround(place));
  const Index side = SamplesToEachSide(record);
  const Index first = std::max<Index>(0, at - side);
  const Index last = std::min(record.samples() - 1, at + side);
  std::vector<Index> samples;
  for (Index k = first; k <= last; ++k) {
    if (channel.IsMeasured(k)) samples.push_back(k);
  }
  if (samples.empty()) samples.push_back(std::clamp(at, first, last));
  MatrixXd basis(static_cast<Index>(samples.size()), 3);
  VectorXd values(basis.rows());
  for (Index i = 0; i < basis.rows(); ++i) {
    const Index k = samples[static_cast<std::size_t>(i)];
    const double t = static_cast<double>(k) - place;
    basis.row(i) << 1.0, t, 0.5 * t * t;
    values[i] = channel.samples[k];
  }
  Vector3d fit = LeastNorm(basis, values);
  fit[1] /= record.sample_time();
  fit[2] /= record.sample_time() * record.sample_time();
  return fit;
}

using Readings = std::map<std::string, Vector3d>;  // of sensor channels

std::map<std::string, double> ReadingsAfter(const Readings& readings, double time) {
  std::map<std::string, double> after;
  for (const auto& [channel, fit] : readings) {
    after[channel] = fit[0] + time * fit[1] + 0.5 * time * time * fit[2];
  }
  return after;
}

/// What sensors of velocities add to the motion that position sensors see.
void AddVelocities(const Machine& machine, const Readings& readings,
                   const VectorXd& qpos, VectorXd& velocity, VectorXd& acceleration) {
  const mjModel& plant = machine.plant();
  PlantForces forces(plant, qpos);
  std::vector<int> addresses;
  std::vector<Vector3d> wanted;
  for (std::size_t i = 0; i < machine.channels().sensors.size(); ++i) {
    const SensorSetup& sensor = machine.channels().sensors[i];
    const auto reading = readings.find(sensor.channel);
    if (StageOf(plant, sensor) != mjSTAGE_VEL || reading == readings.end()) continue;
    addresses.push_back(machine.sensor_addresses()[i]);
    wanted.push_back(reading->second);
  }
  if (addresses.empty()) return;
  const auto read = [&]() -> VectorXd {
    forces.Update();
    return VectorXd::Map(forces.data().sensordata, plant.nsensordata)(addresses);
  };
  VectorXd::Map(forces.data().qvel, plant.nv) = velocity;
  const MatrixXd by_velocity = ByVelocity(forces, read);
  VectorXd missing = -read();
  VectorXd missing_slope = -by_velocity * acceleration;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    missing[static_cast<Index>(i)] += wanted[i][0];
    missing_slope[static_cast<Index>(i)] += wanted[i][1];
  }
  // Motions that position sensors see are known better.
  const MatrixXd seen = OutputMatrix(plant, machine.channels(), qpos).transpose();
  const MatrixXd unseen =
      MatrixXd::Identity(plant.nv, plant.nv) - PseudoInverse(seen) * seen;
  velocity += unseen * LeastNorm(by_velocity * unseen, missing);
  acceleration += unseen * LeastNorm(by_velocity * unseen, missing_slope);
}

}  // namespace

OperatingPoint MomentOf(const Machine& machine, const Record& record, double time) {
  const double end = record.start_time() + record.duration();
  if (!(time >= record.start_time() && time <= end)) {
    throw InputError("record", "has no sample at " + std::to_string(time) + " s",
                     "a time from " + std::to_string(record.start_time()) + " to " +
                         std::to_string(end) + " s");
  }
  const Channels& channels = machine.channels();
  const mjModel& plant = machine.plant();
  Readings readings;
  for (const SensorSetup& sensor : channels.sensors) {
    const Channel* channel = record.Find(sensor.channel);
    if (channel == nullptr) continue;
    readings[sensor.channel] = SmoothAt(*channel, record, time);
  }
  VectorXd inputs(static_cast<Index>(channels.actuators.size()));
  for (Index i = 0; i < inputs.size(); ++i) {
    const std::string& name = channels.actuators[static_cast<std::size_t>(i)].channel;
    inputs[i] = SmoothAt(record.At(name), record, time)[0];
  }
  const double half =
      static_cast<double>(SamplesToEachSide(record)) * record.sample_time();
  const auto at = [&](const VectorXd& from, double after) {
    return StartPosition(channels, plant, from, ReadingsAfter(readings, after));
  };
  const VectorXd here = at(machine.rest(), 0.0);
  const VectorXd forth = Displacement(plant, here, at(here, half));
  const VectorXd back = Displacement(plant, here, at(here, -half));
  VectorXd velocity = (forth - back) / (2.0 * half);
  VectorXd acceleration = (forth + back) / (half * half);
  AddVelocities(machine, readings, here, velocity, acceleration);
  return MovingAt(plant, channels, here, velocity, acceleration, inputs);
}

}  // namespace mjdiag
