#include "mjdiag/studies/tolerance_study.h"

#include <gtest/gtest.h>

#include "support/bonder.h"

namespace mjdiag {
namespace {

// That the twin's estimate becomes one of the machine as it is since then, not of both.
TEST(TryTolerance, CorrectsFaultsThatAppearTogetherMidway) {
  const Machine bonder = test::Bonder();
  const ToleratedRun run = TryTolerance(
      bonder, PlanTolerance(bonder), {{"eta_x", 0.7}, {"zeta_x", 2.0}, {"gamma", 1.0}},
      1.0, Teller::kTwin, true, 1);
  EXPECT_GT(run.uncorrected, 5.0);
  EXPECT_LT(run.corrected, 1.1);
  EXPECT_LT(run.since, 1.0);
}

}  // namespace
}  // namespace mjdiag
