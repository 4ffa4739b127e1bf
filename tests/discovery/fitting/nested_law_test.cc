#include "mjdiag/discovery/fitting/nested_law.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

class NestedLaw : public testing::Test {
 protected:
  test::StageUnderTest stage_;
  std::vector<Candidate> candidates_ = ListCandidates(stage_.machine);

  std::optional<FittedCause> SimplerOf(const std::string& name,
                                       const Eigen::VectorXd& value) const {
    return SimplerLaw(stage_.machine.plant(), candidates_,
                      {test::Place(candidates_, name), value});
  }
};

TEST_F(NestedLaw, AResonanceThatIsEverStifferIsAMass) {
  const auto simpler =
      SimplerOf("flexible_mode@load", Eigen::Vector3d(0.7, 300.0, 0.01));
  ASSERT_TRUE(simpler);
  EXPECT_EQ(simpler->candidate, test::Place(candidates_, "added_mass@load"));
  EXPECT_EQ(simpler->value[0], 0.7);
}

// 203.5 N s/m is the damping of the stage: 10 % more on average is zeta = 1.1.
TEST_F(NestedLaw, TheFaultParameterStandsForTheSymmetricLawThatItIs) {
  const double damping = stage_.machine.plant().dof_damping[0];
  const auto simpler = SimplerOf("asymmetric_viscous_friction@load",
                                 Eigen::Vector2d(0.05 * damping, 0.15 * damping));
  ASSERT_TRUE(simpler);
  EXPECT_EQ(simpler->candidate, test::Place(candidates_, "zeta"));
  EXPECT_NEAR(simpler->value[0], 1.1, 1e-12);
}

TEST_F(NestedLaw, ACableThatLosesMoreThanCablesDoIsFriction) {
  const auto spring =
      SimplerOf("hysteretic_stiffness@load", Eigen::Vector3d(4.0, 2.0, 0.01));
  ASSERT_TRUE(spring);
  EXPECT_EQ(spring->candidate, test::Place(candidates_, "linear_stiffness@load"));
  const auto friction =
      SimplerOf("hysteretic_stiffness@load", Eigen::Vector3d(4.0, 10.0, 0.01));
  ASSERT_TRUE(friction);
  EXPECT_EQ(friction->candidate,
            test::Place(candidates_, "presliding_hysteresis@load"));
  EXPECT_TRUE(friction->value.isApprox(Eigen::Vector2d(0.4, 40.0)));
}

TEST_F(NestedLaw, ASimpleLawHasNone) {
  EXPECT_FALSE(SimplerOf("coulomb_friction@load", Eigen::VectorXd::Constant(1, 3.0)));
}

TEST_F(NestedLaw, ALargerLawContainsTheSimplerAsItIs) {
  const auto larger = [&](const std::string& name, const Eigen::VectorXd& value,
                          const std::string& simpler, const Eigen::VectorXd& as) {
    const FittedCause found = Containing(stage_.machine.plant(), candidates_,
                                         {test::Place(candidates_, name), value},
                                         {test::Place(candidates_, simpler), as});
    const auto back = SimplerLaw(stage_.machine.plant(), candidates_, found);
    EXPECT_TRUE(back && back->value.isApprox(as, 1e-6)) << name;
    return found.value;
  };
  const Eigen::VectorXd hysteresis =
      larger("bouc_wen@load", Eigen::Vector4d(75.0, 66.5, 7.4, 1.0),
             "presliding_hysteresis@load", Eigen::Vector2d(2.9, 645.0));
  EXPECT_DOUBLE_EQ(hysteresis[2], 7.4);
  EXPECT_DOUBLE_EQ(hysteresis[3], 1.0);
  const Eigen::VectorXd drag =
      larger("asymmetric_viscous_friction@load", Eigen::Vector2d(10.0, 40.0), "zeta",
             Eigen::VectorXd::Constant(1, 1.2));
  EXPECT_GT(drag[1], drag[0]);  // in proportion
}

}  // namespace
}  // namespace mjdiag
