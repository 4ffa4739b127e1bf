#pragma once
// How fast what a sensor reads changes.

#include <mujoco/mujoco.h>

namespace mjdiag {

/// Whether a sensor reads a position whose rate follows from positions and velocities: of a
/// joint, a tendon, an actuator, or of a frame, in that of another one if it has a reference.
bool HasRate(const mjModel& model, int sensor);

/// d/dt of a component of what the sensor reads, where data have velocities; 0 of those that
/// have no such rate. [unit of the sensor / s]
double ReadingRate(const mjModel& model, const mjData& data, int sensor,
                   int component) noexcept;

}  // namespace mjdiag
