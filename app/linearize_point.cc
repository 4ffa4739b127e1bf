#include "app/linearize_point.h"

#include <cmath>

#include "app/format.h"
#include "app/subject.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/replay/record_moment.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

OperatingPoint HeldWhere(const Machine& machine, const mjtNum* qpos) {
  const mjModel& plant = machine.plant();
  return HeldAt(plant, machine.channels(),
                PoseAt(plant, VectorXd::Map(qpos, plant.nq)));
}

NamedPoint AtKeyframe(const Machine& machine, const std::string& name) {
  const mjModel& plant = machine.plant();
  const int key = mj_name2id(&plant, mjOBJ_KEY, name.c_str());
  if (key < 0) {
    std::string names;
    for (int i = 0; i < plant.nkey; ++i) {
      names += (i == 0 ? "" : ", ") + ElementName(plant, mjOBJ_KEY, i);
    }
    throw InputError(
        "--at", "the plant has no keyframe '" + name + "'",
        names.empty() ? "rest or start: it has none at all" : "one of " + names);
  }
  return {HeldWhere(machine, plant.key_qpos + key * plant.nq),
          "keyframe '" + name + "'"};
}

NamedPoint AtMoment(const Machine& machine, const std::string& file,
                    const std::string& time, std::vector<std::string>& notes) {
  const auto seconds = ParseNumber(time);
  if (!seconds || !std::isfinite(*seconds)) {
    throw InputError("--at", "'" + time + "' is no time",
                     "RECORD@TIME, TIME in seconds");
  }
  const Record record = ReadMeasured(machine.setup(), file, notes);
  return {MomentOf(machine, record, *seconds),
          FormatQuantity(*seconds, "s") + " of " + file};
}

/// Of every coordinate, those that are more than rounding.
std::vector<std::pair<std::string, double>> Named(const mjModel& plant,
                                                  const VectorXd& values) {
  const std::vector<std::string> names = CoordinateNames(plant);
  std::vector<std::pair<std::string, double>> named;
  const double negligible =
      1e-9 * (values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0);
  for (Index i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) <= negligible) continue;
    named.emplace_back(names[static_cast<std::size_t>(i)], values[i]);
  }
  return named;
}

std::string Forces(const mjModel& plant, const VectorXd& force) {
  constexpr std::size_t kShown = 6;
  const std::vector<std::string> names = CoordinateNames(plant);
  const auto named = Named(plant, force);
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, named.size()); ++i) {
    const auto dof = static_cast<int>(
        std::find(names.begin(), names.end(), named[i].first) - names.begin());
    text += (i == 0 ? "" : ", ") +
            FormatQuantity(named[i].second, IsLength(plant, dof) ? "N" : "N m") +
            " at " + named[i].first;
  }
  if (named.size() > kShown) {
    text += " and at " + std::to_string(named.size() - kShown) + " more";
  }
  return text;
}

nlohmann::json PoseJson(const mjModel& plant, const VectorXd& qpos) {
  nlohmann::json pose = nlohmann::json::object();
  for (int joint = 0; joint < plant.njnt; ++joint) {
    const int type = plant.jnt_type[joint];
    const int first = plant.jnt_qposadr[joint];
    const Index numbers = type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1;
    const VectorXd values = qpos.segment(first, numbers);
    const std::string name = ElementName(plant, mjOBJ_JOINT, joint);
    if (numbers == 1) {
      pose[name] = values[0];
    } else {
      pose[name] = std::vector<double>(values.begin(), values.end());
    }
  }
  return pose;
}

nlohmann::json CoordinateJson(const mjModel& plant, const VectorXd& values) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, value] : Named(plant, values)) json[name] = value;
  return json;
}

}  // namespace

std::string RecordOfPoint(const std::string& at) {
  const std::size_t sign = at.rfind('@');
  return at.starts_with("keyframe:") || sign == at.npos ? "" : at.substr(0, sign);
}

NamedPoint FindPoint(const Machine& machine, const std::string& at,
                     std::vector<std::string>& notes) {
  const std::string keyframe = "keyframe:";
  if (at == "rest") {
    return {HeldAt(machine.plant(), machine.channels(), machine.rest_pose()), "rest"};
  }
  if (at == "start") return {HeldWhere(machine, machine.plant().qpos0), "start"};
  if (at.starts_with(keyframe)) return AtKeyframe(machine, at.substr(keyframe.size()));
  const std::size_t sign = at.rfind('@');
  if (sign == at.npos) {
    throw InputError("--at", "'" + at + "' is no place",
                     "rest, start, keyframe:NAME or RECORD@TIME");
  }
  return AtMoment(machine, at.substr(0, sign), at.substr(sign + 1), notes);
}

nlohmann::json PointJson(const Machine& machine, const NamedPoint& named, bool stable) {
  const OperatingPoint& point = named.point;
  const mjModel& plant = machine.plant();
  nlohmann::json inputs = nlohmann::json::object();
  for (std::size_t i = 0; i < machine.channels().actuators.size(); ++i) {
    const int actuator = machine.actuator_addresses()[i];
    const int activation = ActivationOf(plant, actuator);
    inputs[machine.channels().actuators[i].channel] =
        activation < 0 ? point.controls[actuator] : point.activation[activation];
  }
  nlohmann::json json = {{"at", named.place},
                         {"pose", PoseJson(plant, point.qpos)},
                         {"rests", point.rests},
                         {"stable", stable},
                         {"holding_force", CoordinateJson(plant, point.holding_force)},
                         {"applied_force", CoordinateJson(plant, point.applied_force)},
                         {"inputs", inputs}};
  if (!point.velocity.isZero(0.0)) {
    json["velocity"] = CoordinateJson(plant, point.velocity);
  }
  return json;
}

std::string PlaceText(const Machine& machine, const NamedPoint& named, bool stable) {
  const OperatingPoint& point = named.point;
  const mjModel& plant = machine.plant();
  std::string text;
  if (named.place == "rest") {
    text = point.rests ? "about its rest" : "nothing rests: about the pose drawn";
  } else if (named.place == "start") {
    text = "about the pose drawn";
  } else {
    text = "about " + named.place;
  }
  const bool moves = !point.velocity.isZero(0.0);
  // What rounding leaves of a force that actuators make is none.
  const bool applied = point.applied_force.norm() > 1e-6 * point.holding_force.norm();
  if (moves && applied) {
    text += ", where the model lacks " + Forces(plant, point.applied_force);
  } else if (!moves && !point.rests && !Named(plant, point.holding_force).empty()) {
    text += (applied ? ", held by " : ", held by its actuators with ") +
            Forces(plant, point.holding_force);
  }
  if (!stable) text += "\nthe pose is not stable: left alone, the machine leaves it";
  return text;
}

}  // namespace mjdiag::app
