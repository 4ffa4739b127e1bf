#include "mjdiag/plugin/replay/tangent_course.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "support/arm.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct FollowedArm {
  explicit FollowedArm(const std::vector<std::string>& effects)
      : machine(test::Arm().machine.With(test::With(effects))),
        run(ToMeasuredRun(machine.setup(), test::Arm::Measure(effects))) {}

  /// Behind the noise of the machine itself: by what pushes an arm about A follows, too.
  FilterPath Follow() const {
    return RunForceFilter(machine, run, LatentDofs(machine, run),
                          FilterStarts(machine, run, sd), noise);
  }

  VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  Machine machine;
  MeasuredRun run;
  FilterNoise noise = FilterLikeliest(machine, run, sd).noise;
};

// Forces that depend on positions, on velocities and on both, one of them with a memory.
std::vector<std::string> Laws() {
  return {"cubic_stiffness@elbow:coefficient=0.5",
          "quadratic_drag@elbow:coefficient=0.05",
          "hysteretic_stiffness@shoulder:stiffness=2,loss=0.3,length=0.1"};
}

TEST(TangentCourse, WithWhatEffectsPushWithIsTheTangentByDifferencesOfTheTick) {
  const FollowedArm arm(Laws());
  const FilterPath path = arm.Follow();
  TickMap map(arm.machine);
  ASSERT_TRUE(map.EffectsFollowTheirJoints());
  TickDifferences differences(map, arm.machine.rates().tick(), {0, 1});
  RecordedInputs inputs(arm.machine, arm.run);
  VectorXd forces = VectorXd::Zero(2);
  double worst = 0.0;
  for (Index k = 0; k < path.samples(); ++k) {
    const PlantState& state = path.states[static_cast<std::size_t>(k)];
    forces(path.dofs) = path.forces.col(k);
    inputs.StayAt(k);
    map.Run(state, forces, arm.run.TickOf(k), inputs);
    if (k % 100 != 0) continue;
    const TickTangent tick = differences.Of(state, forces, arm.run.TickOf(k), inputs);
    worst = std::max(worst, (path.At(k).A - tick.A).norm() / tick.A.norm());
    worst = std::max(worst, (path.At(k).B - tick.B).norm() / tick.B.norm());
  }
  // Tangents are kept as long as they change by less than a thousandth.
  EXPECT_LT(worst, 2e-3);
}

}  // namespace
}  // namespace mjdiag
