#pragma once
// Where a run begins.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <string>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Readings of the setup's sensors with the machine at rest at `qpos`, nsensor.
Eigen::VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                               const Eigen::VectorXd& qpos);
/// The same with data of the model, for many positions: it is large to make.
Eigen::VectorXd SensorReadings(const Channels& channels, const mjModel& model,
                               const Eigen::VectorXd& qpos, mjData& data);

/// Joint positions at rest: the static equilibrium `rest`, moved so that the named
/// sensors read `start`. Of all ways to move there the one that strains the springs least is
/// taken: dq = W b (b^T W b)^-1 dy with W = 1 / (1 + k) per joint. NumericalError if
/// the sensors cannot read that.
Eigen::VectorXd StartPosition(const Channels& channels, const mjModel& model,
                              const Eigen::VectorXd& rest,
                              const std::map<std::string, double>& start);

}  // namespace mjdiag
