#include "mjdiag/plugin/draft/plant_places.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

void AddName(const mjModel& model, mjtObj kind, int id,
             std::vector<std::string>& names) {
  const char* name = mj_id2name(&model, kind, id);
  if (name == nullptr || name[0] == '\0') return;
  if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
}

std::string PositionUnit(const mjModel& model, int joint) {
  return model.jnt_type[joint] == mjJNT_SLIDE ? "m" : "rad";
}

int DrivenJoint(const mjModel& model, int actuator) {
  const int kind = model.actuator_trntype[actuator];
  if (kind != mjTRN_JOINT && kind != mjTRN_JOINTINPARENT) return -1;
  const int joint = model.actuator_trnid[2 * actuator];
  return IsScalar(model, joint) ? joint : -1;
}

void AddMotorNames(const mjModel& model, int joint, std::vector<std::string>& names) {
  for (int id = 0; id < model.nu; ++id) {
    if (DrivenJoint(model, id) == joint) AddName(model, mjOBJ_ACTUATOR, id, names);
  }
}

void AddTendonNames(const mjModel& model, int tendon, std::vector<std::string>& names) {
  AddName(model, mjOBJ_TENDON, tendon, names);
  const int first = model.tendon_adr[tendon];
  for (int wrap = first; wrap < first + model.tendon_num[tendon]; ++wrap) {
    if (model.wrap_type[wrap] != mjWRAP_JOINT) continue;
    // Where a tendon has no number of its own, its first joint's is meant.
    const PlaceWords place = ReadPlaceWords(names.front());
    const std::string joint = ElementName(model, mjOBJ_JOINT, model.wrap_objid[wrap]);
    const PlaceWords of_joint = ReadPlaceWords(joint);
    if (place.numbers.empty() && !of_joint.numbers.empty()) {
      names.push_back(names.front() + std::to_string(of_joint.numbers.front()));
    }
    return;
  }
}

struct SensorKind {
  Quantity quantity;
  std::string unit;
};

SensorKind KindOf(const mjModel& model, int sensor) {
  using enum Quantity;
  const int object = model.sensor_objid[sensor];
  switch (model.sensor_type[sensor]) {
    case mjSENS_JOINTPOS:
      return {kPosition, PositionUnit(model, object)};
    case mjSENS_JOINTVEL:
      return {kVelocity, PositionUnit(model, object) + "/s"};
    case mjSENS_TENDONPOS:
      return {kPosition,
              model.tendon_num[object] > 0 &&
                      model.wrap_type[model.tendon_adr[object]] == mjWRAP_JOINT &&
                      model.jnt_type[model.wrap_objid[model.tendon_adr[object]]] ==
                          mjJNT_HINGE
                  ? "rad"
                  : "m"};
    case mjSENS_ACTUATORPOS: {
      const int joint = DrivenJoint(model, object);
      return {kPosition, joint >= 0 ? PositionUnit(model, joint) : "m"};
    }
    case mjSENS_ACTUATORVEL: {
      const int joint = DrivenJoint(model, object);
      return {kVelocity, (joint >= 0 ? PositionUnit(model, joint) : "m") + "/s"};
    }
    case mjSENS_ACTUATORFRC: {
      const int joint = DrivenJoint(model, object);
      const bool slide = joint < 0 || model.jnt_type[joint] == mjJNT_SLIDE;
      return {kDrive, slide ? "N" : "N m"};
    }
    case mjSENS_FRAMEPOS:
    case mjSENS_SUBTREECOM:
      return {kPosition, "m"};
    case mjSENS_ACCELEROMETER:
    case mjSENS_FRAMELINACC:
      return {kAcceleration, "m/s^2"};
    case mjSENS_GYRO:
    case mjSENS_FRAMEANGVEL:
      return {kVelocity, "rad/s"};
    case mjSENS_VELOCIMETER:
    case mjSENS_FRAMELINVEL:
      return {kVelocity, "m/s"};
    case mjSENS_FORCE:
      return {kDrive, "N"};
    case mjSENS_TORQUE:
      return {kDrive, "N m"};
    default:
      return {kUnknown, "1"};
  }
}

/// What a log calls the components of a vector: with a letter or a number behind the name,
/// or by the letter alone.
std::vector<std::string> ComponentNames(const std::string& sensor, int type,
                                        int component) {
  const std::string letter(1, static_cast<char>('x' + component));
  std::vector<std::string> names{sensor + "_" + letter,
                                 sensor + "_" + std::to_string(component)};
  switch (type) {
    case mjSENS_FRAMEPOS:
      names.push_back(letter);
      break;
    case mjSENS_GYRO:
      for (const char* word : {"w", "gyro", "omega"}) names.push_back(word + letter);
      break;
    case mjSENS_ACCELEROMETER:
      for (const char* word : {"a", "acc"}) names.push_back(word + letter);
      break;
    case mjSENS_FORCE:
      names.push_back("f" + letter);
      break;
    case mjSENS_TORQUE:
      for (const char* word : {"t", "m"}) names.push_back(word + letter);
      break;
    default:
      break;
  }
  return names;
}

void AddSensor(const mjModel& model, int sensor, std::vector<Reading>& readings) {
  const char* name = mj_id2name(&model, mjOBJ_SENSOR, sensor);
  if (name == nullptr || name[0] == '\0') return;  // a setup could not name it
  const SensorKind kind = KindOf(model, sensor);
  const int type = model.sensor_type[sensor];
  Reading reading{name, 0, -1, true, kind.quantity, kind.unit, {name}};
  const int object = model.sensor_objid[sensor];
  reading.by_name_only = type != mjSENS_JOINTVEL && type != mjSENS_TENDONPOS;
  if (type == mjSENS_JOINTVEL) {
    reading.joint = object;
    AddName(model, mjOBJ_JOINT, object, reading.names);
  } else if (type == mjSENS_TENDONPOS) {
    AddTendonNames(model, object, reading.names);
  } else if (type == mjSENS_ACTUATORPOS || type == mjSENS_ACTUATORVEL ||
             type == mjSENS_ACTUATORFRC) {
    AddName(model, mjOBJ_ACTUATOR, object, reading.names);
  }
  const int count = model.sensor_dim[sensor];
  for (int component = 0; component < count; ++component) {
    reading.component = component;
    if (count > 1) {
      if (count > 3) return;  // an orientation: nobody logs it by one name
      reading.names = ComponentNames(name, type, component);
    }
    readings.push_back(reading);
  }
}

Reading JointReading(const mjModel& model, int joint) {
  Reading reading{"", 0, joint, false, Quantity::kPosition, PositionUnit(model, joint),
                  {}};
  for (int sensor = 0; sensor < model.nsensor && !reading.exists; ++sensor) {
    if (model.sensor_type[sensor] != mjSENS_JOINTPOS ||
        model.sensor_objid[sensor] != joint) {
      continue;
    }
    AddName(model, mjOBJ_SENSOR, sensor, reading.names);
    if (reading.names.empty()) continue;
    reading.exists = true;
    reading.element = reading.names.front();
  }
  reading.joint_name = GivenName(model, mjOBJ_JOINT, joint);
  AddName(model, mjOBJ_JOINT, joint, reading.names);
  AddMotorNames(model, joint, reading.names);
  if (!reading.exists) reading.element = GivenName(model, mjOBJ_JOINT, joint);
  return reading;
}

/// By what makes its force of its control (MJCF shortcuts: position, velocity, motor).
Input InputOf(const mjModel& model, int actuator) {
  const mjtNum* gain = RowOf(model.actuator_gainprm, mjNGAIN, actuator);
  const mjtNum* bias = RowOf(model.actuator_biasprm, mjNBIAS, actuator);
  if (model.actuator_gaintype[actuator] != mjGAIN_FIXED) return Input::kPure;
  if (model.actuator_biastype[actuator] != mjBIAS_AFFINE) return Input::kForce;
  if (bias[1] != 0.0 && bias[1] == -gain[0]) return Input::kPosition;
  if (bias[1] == 0.0 && bias[2] == -gain[0] &&
      model.actuator_gear[static_cast<std::ptrdiff_t>(6) * actuator] == 1.0) {
    return Input::kVelocity;
  }
  return bias[2] != 0.0 ? Input::kVoltage : Input::kForce;
}

}  // namespace

std::string GivenName(const mjModel& model, mjtObj kind, int id) {
  const char* name = mj_id2name(&model, kind, id);
  if (name != nullptr && name[0] != '\0') return name;
  std::string given = std::string(mju_type2Str(kind)) + "_" + std::to_string(id);
  while (mj_name2id(&model, kind, given.c_str()) >= 0) given += "_";
  return given;
}

bool IsScalar(const mjModel& model, int joint) {
  return model.jnt_type[joint] == mjJNT_SLIDE || model.jnt_type[joint] == mjJNT_HINGE;
}

std::vector<Reading> PlantReadings(const mjModel& model) {
  std::vector<Reading> readings;
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (IsScalar(model, joint)) readings.push_back(JointReading(model, joint));
  }
  for (int sensor = 0; sensor < model.nsensor; ++sensor) {
    if (model.sensor_type[sensor] != mjSENS_JOINTPOS)
      AddSensor(model, sensor, readings);
  }
  return readings;
}

std::vector<Drive> PlantDrives(const mjModel& model) {
  std::vector<Drive> drives;
  for (int id = 0; id < model.nu; ++id) {
    Drive drive;
    drive.actuator = id;
    drive.joint = DrivenJoint(model, id);
    AddName(model, mjOBJ_ACTUATOR, id, drive.names);
    drive.element = GivenName(model, mjOBJ_ACTUATOR, id);
    drive.input = InputOf(model, id);
    drive.is_force = drive.input == Input::kForce &&
                     RowOf(model.actuator_gear, 6, id)[0] == 1.0 &&
                     RowOf(model.actuator_gainprm, mjNGAIN, id)[0] == 1.0;
    const bool slide = drive.joint >= 0 && model.jnt_type[drive.joint] == mjJNT_SLIDE;
    const bool hinge = drive.joint >= 0 && !slide;
    switch (drive.input) {
      case Input::kForce:
        drive.unit = hinge ? "N m" : "N";
        break;
      case Input::kVoltage:
        drive.unit = "V";
        break;
      case Input::kPosition:
        drive.unit = hinge ? "rad" : "m";
        break;
      case Input::kVelocity:
        drive.unit = hinge ? "rad/s" : "m/s";
        break;
      case Input::kPure:
        drive.unit = "1";
    }
    if (model.actuator_dyntype[id] != mjDYN_NONE && drive.input == Input::kForce) {
      drive.is_force = false;
    }
    if (drive.joint >= 0) AddName(model, mjOBJ_JOINT, drive.joint, drive.names);
    if (model.actuator_trntype[id] == mjTRN_TENDON) {
      AddName(model, mjOBJ_TENDON, model.actuator_trnid[2 * id], drive.names);
    }
    drives.push_back(std::move(drive));
  }
  for (int joint = 0; joint < model.njnt; ++joint) {
    if (!IsScalar(model, joint)) continue;
    if (std::ranges::any_of(drives, [&](const Drive& d) { return d.joint == joint; })) {
      continue;
    }
    Drive drive{GivenName(model, mjOBJ_JOINT, joint),
                -1,
                joint,
                Input::kForce,
                model.jnt_type[joint] == mjJNT_SLIDE ? "N" : "N m",
                true,
                {}};
    AddName(model, mjOBJ_JOINT, joint, drive.names);
    drives.push_back(std::move(drive));
  }
  return drives;
}

}  // namespace mjdiag
