#include "mjdiag/discovery/hypotheses/fitted_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

FittedCause OneOf(const std::vector<Candidate>& candidates, const std::string& site,
                  double value) {
  return {test::Place(candidates, site), Eigen::VectorXd::Constant(1, value)};
}

TEST(PriorOf, CountsSizesInUnitsOfTheMachine) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure({}));
  auto candidates = ListCandidates(stage.machine);
  BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
  const double force =
      candidates[test::Place(candidates, "coulomb_friction@load")].parameters[0].spread;
  const double missing = 2.0 * std::log(kMissing);
  const FittedCause friction = OneOf(candidates, "coulomb_friction@load", 0.5 * force);
  EXPECT_NEAR(PriorOf(candidates, FittedModel({friction})), 0.25 - missing, 1e-12);
  // A factor of 1 is nothing; encoders are right to 3 in 1000, and seldom are not.
  const FittedCause scale = OneOf(candidates, "encoder_scale@load_encoder", 1.006);
  EXPECT_NEAR(PriorOf(candidates, FittedModel({scale})),
              4.0 - 2.0 * std::log(kSome) - missing, 1e-9);
  const FittedModel all({friction, scale}, Eigen::Vector2d(1.0, -2.0));
  EXPECT_NEAR(PriorOf(candidates, all),
              0.25 + 4.0 - 2.0 * std::log(kSome) - 2.0 * missing + 5.0, 1e-9);
}

}  // namespace
}  // namespace mjdiag
