#pragma once
// Where the channels of a setup lie in MuJoCo's data.

#include <mujoco/mujoco.h>

#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Index into mjData.sensordata of every sensor channel of the setup. InputError names
/// a missing element or a component that the sensor does not have.
std::vector<int> SensorAddresses(const Channels& channels, const mjModel& model);
/// Index into mjData.ctrl of every actuator channel of the setup.
std::vector<int> ActuatorAddresses(const Channels& channels, const mjModel& model);

/// From which stage of a step on MuJoCo knows what a sensor channel reads: of positions,
/// of velocities, or of accelerations and forces.
mjtStage StageOf(const mjModel& model, const SensorSetup& sensor);

/// What a record has of a joint: "joint.<name>" in m or rad.
Channel JointChannel(const mjModel& model, int joint, Eigen::VectorXd samples);

}  // namespace mjdiag
