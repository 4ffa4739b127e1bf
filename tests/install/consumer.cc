#include <cstdio>

#include "mjdiag/plugin/runtime/simulation.h"

int main(int, char** argv) {
  const mjdiag::Machine machine(mjdiag::ReadSetup(argv[1]));
  mjdiag::Trajectory trajectory = machine.setup().trajectories.Find("x");
  trajectory.duration = 0.01;
  const mjdiag::Record record = mjdiag::Simulate(
      machine, mjdiag::FollowTrajectory(machine.setup(), trajectory), {});
  std::printf("%d samples\n", static_cast<int>(record.samples()));
  return record.samples() == 80 ? 0 : 1;
}
