#pragma once
// What of a plant a log can be of: what sensors read, what they could read if it had them,
// and what drives it.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/draft/column_words.h"

namespace mjdiag {

/// A number that a sensor gives, or the position of a joint that none reads.
struct Reading {
  std::string element;  ///< sensor; of a joint that none reads, the joint
  int component = 0;    ///< of the sensor's numbers
  int joint = -1;       ///< that alone it is of, a slide or hinge
  bool exists = true;   ///< false: a <jointpos> is to be added
  Quantity quantity = Quantity::kPosition;
  std::string unit;                ///< SI
  std::vector<std::string> names;  ///< by which a log may call it, the surest first
  bool by_name_only = false;       ///< nothing else makes a column one of it
  std::string joint_name{};        ///< of a position of a joint
};

/// What the control of an actuator is.
enum class Input {
  kForce,     ///< the force is that times a gear: of a unit that nobody says
  kVoltage,   ///< a motor with back EMF
  kPosition,  ///< of a servo with its loop in it
  kVelocity,
  kPure  ///< an activation, a muscle
};

struct Drive {
  std::string element;  ///< actuator; of a joint that none drives, the joint
  int actuator = -1;    ///< -1: a <motor> is to be added
  int joint = -1;       ///< that alone it drives, a slide or hinge
  Input input = Input::kForce;
  std::string unit;      ///< SI, of forces that of the joint
  bool is_force = true;  ///< gear and gain are 1: the control is the force itself
  std::vector<std::string> names;
};

/// Positions of slides and hinges in their order, read or not, then the other sensors.
std::vector<Reading> PlantReadings(const mjModel& model);

/// Actuators in their order, then slides and hinges that none drives alone.
std::vector<Drive> PlantDrives(const mjModel& model);

/// The name of a joint or an actuator; of a nameless one that which the drafted plant gives
/// it, "joint_2".
std::string GivenName(const mjModel& model, mjtObj kind, int id);

/// Slides and hinges.
bool IsScalar(const mjModel& model, int joint);

}  // namespace mjdiag
