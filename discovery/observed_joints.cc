#include "mjdiag/discovery/observed_joints.h"

#include <string>

#include "mjdiag/discovery/problem.h"
#include "mjdiag/plugin/mujoco_model.h"

namespace mjdiag {
namespace {

// Of the control rate: fast enough to follow what the model lacks.
constexpr double kBandwidth = 0.02;

}  // namespace

Record WithObservedJoints(const Setup& setup, const mjModel& plant,
                          const Record& measured) {
  const DiscoveryProblem problem =
      PoseProblem(setup, plant, measured, 1.0, kBandwidth * setup.control_rate);
  const Track track = FollowRun(setup, plant, {}, problem.run, problem.observer, true);
  Record seen = measured;
  for (int joint = 0; joint < plant.njnt; ++joint) {
    const std::string name = "joint." + ElementName(plant, mjOBJ_JOINT, joint);
    if (seen.Find(name)) continue;
    const std::string unit = plant.jnt_type[joint] == mjJNT_HINGE ? "rad" : "m";
    seen.Add({name, unit, track.position.row(plant.jnt_dofadr[joint])});
  }
  return seen;
}

}  // namespace mjdiag
