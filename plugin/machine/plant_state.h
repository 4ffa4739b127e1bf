#pragma once
// The state of any MuJoCo model, x = (q, v, act), and deviations from it, dx = [dq; dv; dact]
// of 2 nv + na numbers, dq in tangent coordinates (tangent_coordinates.h). Behind them come
// position and velocity of every body that an effect adds (CarriedBody).

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace mjdiag {

struct PlantState {
  Eigen::VectorXd position;     ///< nq
  Eigen::VectorXd velocity;     ///< nv
  Eigen::VectorXd activation;   ///< na
  Eigen::VectorXd bodies = {};  ///< x_1, x_1', x_2, ..
};

/// 2 nv + na, without bodies of effects.
Eigen::Index TangentSize(const mjModel& model);

PlantState StateOf(const mjModel& model, const mjData& data);
void SetState(const mjModel& model, const PlantState& state, mjData& data);

/// `from` plus the deviation `dx`, which may have more numbers behind.
PlantState Moved(const mjModel& model, const PlantState& from,
                 const Eigen::VectorXd& dx);
/// to - from in tangent coordinates, 2 nv + na, and of the bodies where both have as many.
Eigen::VectorXd Deviation(const mjModel& model, const PlantState& from,
                          const PlantState& to);

}  // namespace mjdiag
