#pragma once
// What a member of a model may be instead that says less: the laws that its law becomes at an
// end of its parameters (Effect::Simpler), the number of the plant that one of them changes,
// and simple laws of its kind at its site.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mjdiag/discovery/fit/model.h"

namespace mjdiag {

struct Instead {
  std::size_t block = 0;
  Eigen::VectorXd values;  ///< to start from
};

std::vector<Instead> SimplerThan(const Member& member, const std::vector<Block>& blocks,
                                 const mjModel& plant);

/// What resists the joint of a member that resists it, too, in the simplest way of every kind:
/// with the load, with the velocity, or always. Small, to begin with.
std::vector<Instead> SimplerResistances(const Member& member,
                                        const std::vector<Block>& blocks);

}  // namespace mjdiag
