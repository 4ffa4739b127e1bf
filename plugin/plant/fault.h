#pragma once
// Fault knobs: a plant declares them itself, as
//   <custom><text name="fault.zeta_x" data="damping X"/></custom>
// and a fault is a knob turned: it scales dof_damping ("damping <joints>"),
// jnt_stiffness ("stiffness <joints>") or actuator_gear ("gear <actuators>").
// [AB383], Eq. 4, 5 and 6.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjdiag {

enum class KnobKind { kDamping, kStiffness, kGear };

struct FaultKnob {
  std::string name;  ///< without "fault."
  KnobKind kind = KnobKind::kDamping;
  std::vector<int> elements;  ///< joint ids, or actuator ids for kGear
};

/// A knob with the factor it is turned to; 1: healthy.
struct Fault {
  std::string name;
  double value = 1.0;

  bool operator==(const Fault&) const = default;
};

/// The knobs that the plant declares, in the order of the file. InputError names an
/// unknown kind of knob, joint or actuator.
std::vector<FaultKnob> FaultKnobs(const mjModel& model);

/// Scales what the knob names. InputError on an unknown knob (lists the known ones), or
/// a value that is not finite and >= 0. The preload of a turned spring is kept as it is
/// in qpos_spring, so the equilibrium moves as it would on the machine.
void ApplyFault(mjModel& model, const Fault& fault);

}  // namespace mjdiag
