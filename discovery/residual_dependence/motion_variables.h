#pragma once
// What a force that nothing explains may depend on: all that a machine does along a
// record.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/residual_dependence/residual_dependence.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/effects/structure/force_curve.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// A variable, and what it is to a force_curve.
struct MotionVariable : Variable {
  /// None: no state of the machine, as an acceleration.
  std::optional<CurveVariable> kind = std::nullopt;
  int of = 0;  ///< degree of freedom or actuator
  /// As a factor.
  CurveFactor factor = CurveFactor::kNone;
};

/// Of a force at joint `site` (nv): positions, velocities and accelerations of `joints`,
/// the direction of the site, the commands of all actuators, and time.
/// @param still    speed of the site below which it has no direction
/// @param records  that the motion holds, one after the other
std::vector<MotionVariable> MotionVariables(const Machine& machine,
                                            const ObservedMotion& motion,
                                            const std::vector<std::string>& joints,
                                            Eigen::Index site, double still,
                                            std::size_t records);

}  // namespace mjdiag
