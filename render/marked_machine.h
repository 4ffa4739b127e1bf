#pragma once
// The machine at rest with some of its parts marked: in a colour of their own, while all
// else is pale.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/render/scene/scene_renderer.h"

namespace mjdiag {

/// Bodies that a fault parameter acts on: those that its joints carry, or that its
/// actuators push.
std::vector<int> BodiesOf(const mjModel& model, const FaultParameter& fault);

/// A PNG. Without a body to be marked the machine has its own colours.
/// @param position  joint positions, nq
/// InputError as SceneRenderer.
std::string DrawMarked(const mjModel& model, const Eigen::VectorXd& position,
                       std::span<const int> bodies, const SceneOptions& options);

}  // namespace mjdiag
