#pragma once
// Fault parameters: a plant declares them itself, as
//   <custom><text name="fault.zeta_x" data="damping X"/></custom>
// and a fault is one of them off its healthy value, 1: it scales dof_damping ("damping
// <joints>"), jnt_stiffness ("stiffness <joints>") or actuator_gear ("gear
// <actuators>"). [AB383], Eq. 4, 5 and 6.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/plant_number.h"

namespace mjdiag {

struct FaultParameter {
  std::string name;  ///< without "fault."
  PlantNumberKind kind = PlantNumberKind::kDamping;
  std::vector<int> elements;  ///< joint ids, or actuator ids for kGear
};

/// A fault parameter with its value; 1: healthy.
struct Fault {
  std::string name;
  double value = 1.0;

  bool operator==(const Fault&) const = default;
};

/// Those that the plant declares, in the order of the file. InputError names an unknown
/// kind of fault parameter, joint or actuator.
std::vector<FaultParameter> FaultParameters(const mjModel& model);

/// Scales what the fault parameter names. InputError on an unknown one (lists the known
/// ones), or a value that is not finite and >= 0. The preload of a faulty spring is
/// kept as it is in qpos_spring, so the equilibrium moves as it would on the machine.
void ApplyFault(mjModel& model, const Fault& fault);

/// Gives a model that runs the values that another of the same plant has of everything
/// that fault parameters scale. Does not allocate.
void CopyFaults(const mjModel& from, mjModel& to) noexcept;
/// Moves them that part of the way there.
void ApproachFaults(const mjModel& target, double part, mjModel& model) noexcept;

}  // namespace mjdiag
