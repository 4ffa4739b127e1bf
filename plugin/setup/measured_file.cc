#include "mjdiag/plugin/setup/measured_file.h"

namespace mjdiag {
namespace {

Course CourseOf(Hold hold) {
  switch (hold) {
    case Hold::kZero:
      return Course::kHeld;
    case Hold::kLinear:
      return Course::kStraight;
    case Hold::kBandLimited:
      return Course::kSmooth;
  }
  return Course::kHeld;
}

}  // namespace

std::map<std::string, ReadingScale> ReadingsOf(const Setup& setup) {
  std::map<std::string, ReadingScale> readings;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    readings[sensor.channel] = {sensor.resolution, sensor.noise_sd};
  }
  return readings;
}

MeasuredFile ReadMeasured(const Setup& setup, const std::filesystem::path& file) {
  Resampling resampling{setup.rates.tick(), {}};
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    resampling.courses[actuator.channel] = CourseOf(actuator.hold);
  }
  for (const AxisSetup& axis : setup.control.axes) {
    resampling.courses[axis.actuator] = Course::kHeld;
    resampling.courses[axis.known_disturbance] = Course::kHeld;
  }
  for (const std::string& name : setup.channels.Switches()) {
    resampling.courses[name] = Course::kSwitched;
  }
  resampling.readings = ReadingsOf(setup);
  return ReadMeasuredFile(file, setup.record, resampling);
}

}  // namespace mjdiag
