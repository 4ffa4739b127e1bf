#include "mjdiag/discovery/fitting/first_values.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

struct FirstValues : ::testing::Test {
  const test::StageUnderTest stage;
  const std::vector<Candidate> candidates = ListCandidates(stage.machine);

  DiscoveryProblem Pose(const std::vector<std::string>& hidden) const {
    return stage.Pose(stage.Measure(hidden));
  }
  FittedCause Cause(const std::string& name, VectorXd value) const {
    return {test::Place(candidates, name), std::move(value)};
  }
};

// Two amplitudes that act alike: what one of them takes away the other may bring.
TEST_F(FirstValues, AreThoseOfOneAmplitudeWhereTheOtherLeadsAstray) {
  const DiscoveryProblem problem =
      Pose({"stribeck_friction@load:coulomb=1,breakaway=1,velocity=0.02"});
  FittedModel model;
  model.causes = {Cause("stribeck_friction@load", Eigen::Vector3d(1.1, 30.0, 0.02))};
  const FittedModel begun = WithFirstValues(problem, candidates, model, nullptr, 0.0);
  EXPECT_EQ(begun.causes[0].value, Eigen::Vector3d(1.1, 0.05 * 30.0, 0.02));
}

TEST_F(FirstValues, AreAShareOfWhatLeadsTooFar) {
  const DiscoveryProblem problem = Pose({"coulomb_friction@load:force=1"});
  FittedModel model;
  model.causes = {Cause("coulomb_friction@load", VectorXd::Constant(1, 20.0))};
  const FittedModel begun = WithFirstValues(problem, candidates, model, nullptr, 0.0);
  EXPECT_EQ(begun.causes[0].value[0], 0.05 * 20.0);
}

TEST_F(FirstValues, AreAsTheyWereWhereTheyAreGoodEnough) {
  const DiscoveryProblem problem = Pose({"coulomb_friction@load:force=1"});
  FittedModel model;
  model.causes = {Cause("coulomb_friction@load", VectorXd::Constant(1, 1.5))};
  const FittedModel begun = WithFirstValues(problem, candidates, model, nullptr, 1e9);
  EXPECT_EQ(begun.causes[0].value[0], 1.5);
}

// A force offset that was found alone has taken over what friction does in one direction.
TEST_F(FirstValues, MoveWhatIsBesideTheNewCause) {
  const DiscoveryProblem problem =
      Pose({"force_offset@load:force=0.2", "coulomb_friction@load:force=1"});
  FittedModel alone;
  alone.causes = {Cause("force_offset@load", VectorXd::Constant(1, 0.5))};
  const CauseFit fit = FitCauses(problem, candidates, alone, {.iterations = 0});
  FittedModel both = alone;
  both.causes.push_back(Cause("coulomb_friction@load", VectorXd::Constant(1, 1.0)));
  const FittedModel begun =
      WithFirstValues(problem, candidates, both, &fit.jacobian, 0.0);
  EXPECT_NEAR(begun.causes[0].value[0], 0.2, 0.1);
  EXPECT_EQ(begun.causes[1].value[0], 1.0);
  EXPECT_EQ(WithFirstValues(problem, candidates, both, nullptr, 0.0).causes[0].value[0],
            0.5);
}

}  // namespace
}  // namespace mjdiag
