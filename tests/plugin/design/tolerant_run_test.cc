#include "mjdiag/plugin/design/tolerant_run.h"

#include <gtest/gtest.h>

#include "support/bonder.h"

namespace mjdiag {
namespace {

TEST(RunTolerantly, CorrectsWhatItsDiagnosisFinds) {
  const Machine bonder = test::Bonder();
  const Machine worn = bonder.With({{{"eta_x", 0.7}}, {}});
  Trajectory trajectory = bonder.setup().trajectories.Find("multi");
  trajectory.duration = 0.3;
  const Excitation motion = FollowTrajectory(bonder.setup(), trajectory);
  DiagnosisSource source;
  source.nominal.linear = true;
  source.nominal.runs = 2;
  const PreparedDiagnosis prepared = PrepareDiagnosis(bonder, source);
  const TolerancePlan plan = PlanTolerance(bonder);
  const auto linear = [&](const RunOptions& options) {
    return SimulateLinear(worn, motion, options);
  };
  const TolerantRun run =
      RunTolerantly(bonder, prepared, plan, motion.samples(), {}, linear);
  ASSERT_EQ(run.faults.size(), 1u);
  EXPECT_EQ(run.faults[0].fault, "eta_x");
  EXPECT_NEAR(run.faults[0].value, 0.7, 1e-3);
  ASSERT_EQ(run.gains.size(), 3u);
  EXPECT_NEAR(run.gains[0], 1.0 / 0.7, 0.01);
  EXPECT_EQ(run.gains[1], 1.0);
  EXPECT_TRUE(run.diagnosis.result.detected);

  const auto error = [&](const Record& record) {
    const auto half = motion.samples() / 2;
    return (record.At("x_ref").samples - record.At("x").samples).tail(half).norm();
  };
  EXPECT_LT(error(run.record), 0.5 * error(linear({})));
}

}  // namespace
}  // namespace mjdiag
