#pragma once
// Laws that the engine does not have, for a benchmark that asks what is said of a machine
// whose cause is in no list: they are effects like those of plugin/effects, but of the
// studies alone, so that nothing that looks for causes knows them.
//
//   rate_and_state_friction  -force a asinh(v / (2 V) exp((1 + b ln(V theta / L)) / a)),
//                        with a contact of age theta that heals at rest,
//                        dtheta/dt = 1 - |v| theta / L (J. H. Dieterich, J. Geophysical
//                        Research 84, 1979; A. Ruina, 88, 1983)
//   root_friction        -force sign(v) sqrt(|v| / velocity): a film that builds up
//   reversal_friction    -force (1 + fresh exp(-s / length)) tanh(v / velocity), s the
//                        travel since the direction last changed
//   periodic_damping     -coefficient (1 + share sin(2 pi q / first) + (1 - share)
//                        sin(2 pi q / second)) v: balls and the joints of a rail
//   dead_zone            a drive that gives nothing within +-width of its command
//   speed_softening      -stiffness q / (1 + (v / velocity)^2): a spring of rubber
//   gyroscopic_coupling  coefficient q w, w the speed of another joint's motor

#include <vector>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

const Effect& RateAndStateFriction();
const Effect& RootFriction();
const Effect& ReversalFriction();
const Effect& PeriodicDamping();
const Effect& DeadZone();
const Effect& SpeedSoftening();
const Effect& GyroscopicCoupling();

/// All of them.
const std::vector<const Effect*>& OutsideLaws();

}  // namespace mjdiag
