#pragma once
// Fault parameters: a plant declares them itself, as
//   <custom><text name="fault.zeta_x" data="damping X"/></custom>
// and a fault is one of them off its healthy value, 1: it scales that number of every
// element named, any kind of model_parameter_kind.h that a factor multiplies: "stiffness
// <joints>", "gear <actuators>", "mass <bodies>", "tendon_damping <tendons>". [AB383], Eq. 4,
// 5 and 6, has dampers, springs and motors.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

struct FaultParameter {
  std::string name;  ///< without "fault."
  ModelParameterKind kind = ModelParameterKind::kDamping;
  std::vector<int> elements;  ///< ids of what ElementOf(kind) says
};

/// A fault parameter with its value; 1: healthy.
struct Fault {
  std::string name;
  double value = 1.0;

  bool operator==(const Fault&) const = default;
};

/// Those that the plant declares, in the order of the file. InputError names an unknown
/// kind of fault parameter or element, and one that has no such number.
std::vector<FaultParameter> FaultParameters(const mjModel& model);

/// Scales what the fault parameter names. InputError on an unknown one (lists the known
/// ones), or a value that is not finite and >= 0. The preload of a faulty spring is
/// kept as it is in qpos_spring, so the equilibrium moves as it would on the machine. What
/// MuJoCo derives from masses goes with them.
void ApplyFault(mjModel& model, const Fault& fault);

/// Gives a model that runs the values that another of the same plant has of everything
/// that fault parameters scale, and of what MuJoCo derives from it. Does not allocate.
void CopyFaults(const mjModel& from, mjModel& to) noexcept;
/// Moves them that part of the way there. What is derived, by which constraints are as soft
/// as masses ask for, goes there in a straight line, too, and is exact at the end.
void ApproachFaults(const mjModel& target, double part, mjModel& model) noexcept;

}  // namespace mjdiag
