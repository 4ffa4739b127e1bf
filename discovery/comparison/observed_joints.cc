#include "mjdiag/discovery/comparison/observed_joints.h"

#include <utility>
#include <vector>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

FilterPath Followed(const Machine& machine, const MeasuredRun& run) {
  const VectorXd reading_sd = SensorNoise(machine.channels(), run);
  const std::vector<Index> dofs = LatentDofs(machine, run);
  const std::vector<FilterStart> starts = FilterStarts(machine, run, reading_sd);
  return RunForceFilter(machine, run, dofs, starts,
                        FollowingNoise(machine, run, dofs, starts, reading_sd));
}

bool HasOneCoordinate(const mjModel& plant, int joint) {
  return plant.jnt_type[joint] == mjJNT_SLIDE || plant.jnt_type[joint] == mjJNT_HINGE;
}

}  // namespace

Record WithObservedJoints(const Machine& machine, const Record& measured) {
  const mjModel& plant = machine.plant();
  const FilterPath path = Followed(machine, ToMeasuredRun(machine.setup(), measured));
  Record seen = measured;
  for (int joint = 0; joint < plant.njnt; ++joint) {
    if (!HasOneCoordinate(plant, joint)) continue;
    const Index place = plant.jnt_qposadr[joint];
    Channel channel =
        JointChannel(plant, joint, VectorXd::NullaryExpr(path.samples(), [&](Index k) {
                       return path.states[static_cast<std::size_t>(k)].position[place];
                     }));
    if (!seen.Find(channel.name)) seen.Add(std::move(channel));
  }
  return seen;
}

}  // namespace mjdiag
