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

/// The configuration in which the named sensors read `start`, from `rest` (nq) on. Those
/// that read positions count, in the order of what is surer:
///
///   1. equality constraints hold: c(q) = 0;
///   2. of the ways to move that they allow, those on which the readings are met best,
///      min sum ((y_i - g_i(q)) / sigma_i)^2, by the noise and the resolution of each
///      sensor: several encoders of one joint need not agree;
///   3. of these the one that strains springs least: min sum (1 + k_j) dq_j^2.
///
/// NumericalError names the sensor whose reading the machine cannot come near, by more than
/// a tenth of a radian or of its size.
Eigen::VectorXd StartPosition(const Channels& channels, const mjModel& model,
                              const Eigen::VectorXd& rest,
                              const std::map<std::string, double>& start);

}  // namespace mjdiag
