#include "mjdiag/discovery/fit/tick_columns.h"

#include <gtest/gtest.h>

#include <utility>

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
  const FilterPath path = FilterLikeliest(arm.machine, run, sd);
  const Whitening whitening(path, KeepGains(path));
  const VectorXd own = PredictAlong(arm.machine, run, path, whitening.gains());
  // An encoder's error is next to what the machine may do: what it leaves is the small
  // difference, of which tangents that are 10 ms old miss a part.
  for (const auto& [effect, share] :
       {std::pair("viscous_friction@elbow:coefficient=1e-3", 0.02),
        std::pair("cubic_stiffness@elbow:coefficient=1e-3", 0.02),
        std::pair("presliding_hysteresis@shoulder:force=1e-3,stiffness=0.01", 0.02),
        std::pair("added_mass@elbow:mass=1e-4", 0.02),
        std::pair("encoder_scale@encoder2:factor=1.0001", 0.15)}) {
    const Machine other = arm.machine.With(test::With({effect}));
    const std::vector<Column> columns = TickColumns(arm.machine, run, path, {{other}});
    const VectorXd expected = PredictAlong(other, run, path, whitening.gains()) - own;
    // What is missing leaves it: what is there takes it away.
    const VectorXd found = -whitening.Of({&columns.front()}).col(0);
    EXPECT_GT(expected.norm(), 0.01) << effect;
    EXPECT_LT((found - expected).norm(), share * expected.norm()) << effect;
  }
}

}  // namespace
}  // namespace mjdiag
