#pragma once
// The constraints that act on a plant, as rows of their Jacobian, and coordinates that are
// independent of each other under them.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Jacobian of rows of constraints of the data, rows x nv, sparse in MuJoCo or not.
Eigen::MatrixXd ConstraintJacobian(const mjModel& model, const mjData& data,
                                   const std::vector<int>& rows);

/// Rows that are equalities.
std::vector<int> EqualityRows(const mjData& data);
/// Rows that hold: equalities, limits and contacts that press (efc_force > 0), those with
/// their friction. Dry friction of joints and tendons is left out.
std::vector<int> HoldingRows(const mjData& data);

/// q = T q_i of small motions that constraints J q = 0 allow.
struct Independence {
  std::vector<int> independent;  ///< coordinates, in order; all of them without rows
  std::vector<int> dependent;
  Eigen::MatrixXd T;  ///< nv x independent: the null space of J, the identity in q_i
};

/// Coordinates of `preference` are made dependent the later the larger it is.
/// @param jacobian    rows x nv, of any rank
/// @param preference  nv, from 0 on
Independence MakeIndependent(const Eigen::MatrixXd& jacobian,
                             const std::vector<int>& preference);

/// Under the rows that hold in these data (HoldingRows). Coordinates that actuator
/// channels drive stay independent before those that sensor channels read, and these
/// before the others.
Independence IndependentCoordinates(const mjModel& model, const Channels& channels,
                                    const mjData& data);

}  // namespace mjdiag
