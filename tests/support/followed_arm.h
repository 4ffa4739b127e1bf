#pragma once
// The arm (arm.h) beside a run of it, and the filter's path.

#include <string>
#include <vector>

#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"

namespace mjdiag::test {

struct FollowedArm {
  explicit FollowedArm(const std::vector<std::string>& lacking, double noise = 1.0)
      : run(ToMeasuredRun(arm.setup(), Arm::Measure(lacking, noise, 2))) {
    const Eigen::VectorXd sd = Eigen::VectorXd::Constant(2, Arm::kNoise);
    const auto dofs = LatentDofs(arm.machine, run);
    const auto starts = FilterStarts(arm.machine, run, sd);
    path = RunForceFilter(arm.machine, run, dofs, starts,
                          FollowingNoise(arm.machine, run, dofs, starts, sd));
  }

  Arm arm;
  MeasuredRun run;
  FilterPath path;
};

}  // namespace mjdiag::test
