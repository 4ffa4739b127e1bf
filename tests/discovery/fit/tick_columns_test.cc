#include "mjdiag/discovery/fit/tick_columns.h"

#include <gtest/gtest.h>

#include "mjdiag/discovery/regression/whitening.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

// What a machine does otherwise in single ticks says, through the filter, what its whole run
// leaves otherwise: of forces, of what it weighs, and of what it reads.
TEST(TickColumns, AreTheDerivativesOfARunWithKeptGains) {
  const test::Arm arm;
  const MeasuredRun run = ToMeasuredRun(arm.setup(), test::Arm::Measure());
  const VectorXd sd = VectorXd::Constant(2, test::Arm::kNoise);
  const auto dofs = LatentDofs(arm.machine, run);
  const auto starts = FilterStarts(arm.machine, run, sd);
  const FilterPath path =
      RunForceFilter(arm.machine, run, dofs, starts,
                     FollowingNoise(arm.machine, run, dofs, starts, sd));
  // Behind little noise of the model.
  FilterNoise noise = path.noise;
  noise.size.setConstant(0.05);
  noise.white.setConstant(1e-3);
  const Whitening whitening(path, KeepGains(path, noise, InflationAlong(path)));
  const VectorXd own = PredictAlong(arm.machine, run, path, whitening.gains());
  for (const char* effect :
       {"viscous_friction@elbow:coefficient=1e-3", "added_mass@elbow:mass=1e-4",
        "encoder_scale@encoder2:factor=1.00001"}) {
    const Machine other = arm.machine.With(test::With({effect}));
    const std::vector<Column> columns = TickColumns(arm.machine, run, path, {{other}});
    const VectorXd expected = PredictAlong(other, run, path, whitening.gains()) - own;
    // What is missing leaves it: what is there takes it away.
    const VectorXd found = -whitening.Of({&columns.front()}).col(0);
    EXPECT_GT(expected.norm(), 0.01) << effect;
    EXPECT_LT((found - expected).norm(), 0.02 * expected.norm()) << effect;
  }
}

}  // namespace
}  // namespace mjdiag
