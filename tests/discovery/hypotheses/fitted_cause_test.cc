#include "mjdiag/discovery/hypotheses/fitted_cause.h"

#include <gtest/gtest.h>

#include <numbers>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"

namespace mjdiag {
namespace {

TEST(FittedCause, IsAtItsEndWhereItsShapeCanGoNoFurther) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure({}));
  auto candidates = ListCandidates(stage.machine);
  BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
  const auto at = [&](const char* name, const Eigen::VectorXd& value) {
    return IsAtItsEnd(candidates, {test::Place(candidates, name), value});
  };
  const double longest =
      candidates[test::Place(candidates, "force_ripple@load")].parameters[1].upper;
  EXPECT_FALSE(at("force_ripple@load", Eigen::Vector3d(1.0, 0.5 * longest, 0.0)));
  EXPECT_TRUE(at("force_ripple@load", Eigen::Vector3d(1.0, longest, 0.0)));
  EXPECT_FALSE(at("flexible_mode@load", Eigen::Vector3d(1.0, 10.0, 0.05)));
  EXPECT_TRUE(at("flexible_mode@load", Eigen::Vector3d(1.0, 10.0, 1.0)));
  // The law without that part is another one.
  const auto& shares =
      candidates[test::Place(candidates, "directional_load_friction@load")].parameters;
  const Eigen::Vector2d expected(shares[0].spread, shares[1].spread);
  EXPECT_FALSE(at("directional_load_friction@load", 0.1 * expected));
  EXPECT_TRUE(at("directional_load_friction@load", Eigen::Vector2d(expected[0], 0.0)));
  // Sizes of 0 of what has no other and phases are no ends.
  EXPECT_FALSE(at("coulomb_friction@load", Eigen::VectorXd::Zero(1)));
  EXPECT_FALSE(at("force_ripple@load",
                  Eigen::Vector3d(1.0, 0.5 * longest, 2.0 * std::numbers::pi)));
}

}  // namespace
}  // namespace mjdiag
