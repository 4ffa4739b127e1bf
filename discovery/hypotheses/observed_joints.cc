#include "mjdiag/discovery/hypotheses/observed_joints.h"

#include <utility>

#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/plant/channels.h"

namespace mjdiag {
namespace {

// Of the control rate: fast enough to follow what the model lacks.
constexpr double kBandwidth = 0.02;

}  // namespace

Record WithObservedJoints(const Machine& machine, const Record& measured) {
  const DiscoveryProblem problem =
      PoseProblem(machine, measured, 1.0, kBandwidth * machine.rates().control);
  const Track& track = problem.Nominal();
  Record seen = measured;
  for (int joint = 0; joint < machine.plant().njnt; ++joint) {
    Channel channel = JointChannel(
        machine.plant(), joint, track.position.row(machine.plant().jnt_dofadr[joint]));
    if (!seen.Find(channel.name)) seen.Add(std::move(channel));
  }
  return seen;
}

}  // namespace mjdiag
