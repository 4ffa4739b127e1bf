#pragma once
// Laws that the engine does not have, for a benchmark that asks what is said of a machine
// whose cause is in no list: they are effects like those of plugin/effects, but of the
// studies alone, so that nothing that looks for causes knows them.
//
//   lugre_friction       bristles that slide: dz/dt = v - stiffness |v| z / g(v), force
//                        stiffness z + damping dz/dt, g(v) = coulomb + breakaway
//                        exp(-(v / velocity)^2) (C. Canudas de Wit, H. Olsson, K. J.
//                        Astrom, P. Lischinsky, IEEE Trans. Automatic Control 40, 1995)
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

const Effect& LugreFriction();
const Effect& RootFriction();
const Effect& ReversalFriction();
const Effect& PeriodicDamping();
const Effect& DeadZone();
const Effect& SpeedSoftening();
const Effect& GyroscopicCoupling();

/// All of them.
const std::vector<const Effect*>& OutsideLaws();

}  // namespace mjdiag
