#include <cstdio>

#include "mjdiag/plugin/runtime/simulation.h"

int main(int, char** argv) {
  const mjdiag::Setup setup = mjdiag::ReadSetup(argv[1]);
  const mjdiag::ModelPtr plant = mjdiag::LoadPlant(setup);
  mjdiag::Trajectory trajectory = setup.trajectories.Find("x");
  trajectory.duration = 0.01;
  const mjdiag::Record record =
      mjdiag::Simulate(setup, *plant, mjdiag::FollowTrajectory(setup, trajectory), {});
  std::printf("%d samples\n", static_cast<int>(record.samples()));
  return record.samples() == 80 ? 0 : 1;
}
