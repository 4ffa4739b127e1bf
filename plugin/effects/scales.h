#pragma once
// What the sizes of effects are measured in: what the machine itself does at a site.

#include <string_view>

#include "mjdiag/plugin/effects/candidate_regressor.h"

namespace mjdiag {

/// Of a run of the machine, at a site.
struct Scales {
  double stroke = 0.0;     ///< of the joint [m, rad]
  double speed = 0.0;      ///< its largest
  double force = 0.0;      ///< the largest command of the motor that moves it
  double stiffness = 0.0;  ///< of the joint's spring
  double strain = 0.0;     ///< largest, of that spring
  double damping = 0.0;
  double mass = 0.0;
  double duration = 0.0;
  double noise = 0.0;  ///< standard deviation, of a sensor

  /// What friction takes of what the motor does, where there is much of it.
  double FrictionForce() const { return 0.3 * force; }
};

/// Along an observed motion. The force is that of the motors on the joint; of a joint
/// without a motor the largest on any.
Scales ScalesOf(const SiteMotion& at);

/// The machine's own size in a unit made of N, m, rad, s and kg, as "N s/m": with the
/// force F, the stroke q and the speed v of a site F / v. A second is q / v. Infinite
/// where the site has none, as one that stands still, or for another unit.
double MachineUnit(const Scales& scales, std::string_view unit);

}  // namespace mjdiag
