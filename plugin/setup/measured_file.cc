#include "mjdiag/plugin/setup/measured_file.h"

#include "mjdiag/signals/error.h"

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

/// Named by its file, as one of several records; what a command wants of it besides, it
/// sees later. A column without a unit may be one that the command does not want.
void RequireUnit(const std::filesystem::path& file, const Record& record,
                 const std::string& name, const std::string& unit) {
  const Channel* channel = record.Find(name);
  if (channel == nullptr || channel->unit == unit || channel->unit == "1") return;
  throw InputError(file.string(),
                   "channel '" + name + "' is in '" + channel->unit + "'",
                   unit + "; a column under [record.channels] may give the unit");
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
  MeasuredFile measured = ReadMeasuredFile(file, setup.record, resampling);
  for (const SensorSetup& sensor : setup.channels.sensors) {
    RequireUnit(file, measured.record, sensor.channel, sensor.unit);
  }
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    RequireUnit(file, measured.record, actuator.channel, actuator.unit);
  }
  return measured;
}

}  // namespace mjdiag
