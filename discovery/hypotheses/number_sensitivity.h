#pragma once
// How the innovations of a run change with numbers of its plant, by the first order of
// every physics step (plant_twin.h): all numbers in one pass, which takes as long as a few
// runs. Differences of whole runs take two for each.
//
// The mass matrix and the motors are those of the machine at rest: beside a machine that
// leaves it by much, forces along the motion (number_forces.h) say more.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/plant_number.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Whether the mass matrix along a run is nearly that of the machine at rest: to a tenth of it,
/// in units in which its diagonal is 1.
/// @param track  with its states
bool StaysNearRest(const Machine& machine, const Track& track);

/// d e / d ln p, means over blocks: (ny blocks) x numbers, sensor index fastest.
/// @param machine  as it runs
/// @param block    ticks; what does not fill one is left out
Eigen::MatrixXd NumberSensitivity(const Machine& machine, const Observer& observer,
                                  const MeasuredRun& run,
                                  const std::vector<PlantNumber>& numbers,
                                  Eigen::Index block);

}  // namespace mjdiag
