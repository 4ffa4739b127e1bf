#pragma once
// What is in a plant only to be looked at, or never used.

#include <mujoco/mujoco.h>

namespace mjdiag {

/// Takes lights, cameras and geoms out of a model that is only going to be stepped:
/// cameras unless a sensor reads one; geoms if none of them can touch anything, hold a
/// tendon or be read by a sensor. Updating a hundred of them costs more than the dynamics
/// of a ten-joint machine. The motion stays bitwise the same. Such a model can make
/// mjData, but cannot be copied or rendered.
void DropScenery(mjModel& model);

/// Makes room for as many rows of constraints (njmax) as the model can have, if its geoms are
/// written not to touch. MuJoCo's own guess of 500 makes each mjData 3 MB that are cleared
/// when it is made or reset, which takes as long as a hundred steps of a stage. The motion
/// stays bitwise the same; a geom that a program lets touch later is noticed as
/// mjWARN_CNSTRFULL.
void DropUnusedRows(mjModel& model);

}  // namespace mjdiag
