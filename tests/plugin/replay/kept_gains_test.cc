#include "mjdiag/plugin/replay/kept_gains.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

struct Followed {
  Followed() {
    const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
    const auto dofs = LatentDofs(arm.machine, run);
    const auto starts = FilterStarts(arm.machine, run, sd);
    path = RunForceFilter(arm.machine, run, dofs, starts,
                          FollowingNoise(arm.machine, run, dofs, starts, sd));
    // Behind little noise of the model.
    FilterNoise noise = path.noise;
    noise.size.setConstant(0.05);
    noise.white.setConstant(1e-3);
    gains = KeepGains(path, noise, OverdispersionAlong(path));
  }

  test::Arm arm;
  MeasuredRun run = ToMeasuredRun(
      arm.setup(), test::Arm::Measure({"viscous_friction@elbow:coefficient=0.05"}));
  FilterPath path;
  KeptGains gains;
};

TEST(KeptGains, PredictWithTheMachineOfThePathWhatItsFilterDid) {
  const Followed followed;
  const FilterPath& path = followed.path;
  const KeptGains own = KeepGains(path);
  const VectorXd left = PredictAlong(followed.arm.machine, followed.run, path, own);
  EXPECT_LT((left - own.left).norm(), 1e-6 * own.left.norm());
}

TEST(KeptGains, LeaveLessWithTheMachineThatWasMeasured) {
  const Followed followed;
  const Machine measured = followed.arm.machine.With(
      test::With({"viscous_friction@elbow:coefficient=0.05"}));
  const VectorXd left =
      PredictAlong(measured, followed.run, followed.path, followed.gains);
  EXPECT_LT(left.squaredNorm(), followed.gains.left.squaredNorm() - 100.0);
}

}  // namespace
}  // namespace mjdiag
