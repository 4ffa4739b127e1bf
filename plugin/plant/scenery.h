#pragma once
// What is in a plant only to be looked at.

#include <mujoco/mujoco.h>

namespace mjdiag {

/// Takes lights, cameras and geoms out of a model that is only going to be stepped:
/// cameras unless a sensor reads one; geoms if none of them can touch anything, hold a
/// tendon or be read by a sensor. Updating a hundred of them costs more than the dynamics
/// of a ten-joint machine. The motion stays bitwise the same. Such a model can make
/// mjData, but cannot be copied or rendered.
void DropScenery(mjModel& model);

}  // namespace mjdiag
