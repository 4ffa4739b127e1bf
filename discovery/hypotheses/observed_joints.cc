#include "mjdiag/discovery/hypotheses/observed_joints.h"

#include <utility>

#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/plant/channels.h"

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
    Channel channel =
        JointChannel(plant, joint, track.position.row(plant.jnt_dofadr[joint]));
    if (!seen.Find(channel.name)) seen.Add(std::move(channel));
  }
  return seen;
}

}  // namespace mjdiag
