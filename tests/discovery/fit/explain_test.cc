#include "mjdiag/discovery/fit/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// @param substeps  2: the physics steps of the model
Explained ExplainedFor(const std::vector<std::string>& lacking, int substeps = 8) {
  const test::Arm arm;
  const MeasuredRun run =
      ToMeasuredRun(arm.setup(), test::Arm::Measure(lacking, 1.0, substeps));
  return Explain(arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise),
                 {.seconds = 300.0, .progress = {}});
}

std::vector<std::string> NamesOf(const Explained& explained) {
  std::vector<std::string> names;
  for (const Member& member : explained.fit.model) {
    names.push_back(explained.blocks[member.block].name);
  }
  return names;
}

double ValueOf(const Explained& explained, const std::string& name) {
  for (const Member& member : explained.fit.model) {
    if (explained.blocks[member.block].name == name) return member.values[0];
  }
  return 0.0;
}

TEST(Explain, HasNothingWhereNothingIsHidden) {
  EXPECT_THAT(NamesOf(ExplainedFor({}, 2)), IsEmpty());
  EXPECT_THAT(NamesOf(ExplainedFor({}, 8)), IsEmpty());
}

TEST(Explain, NamesADamperAndItsSize) {
  const Explained found = ExplainedFor({"viscous_friction@elbow:coefficient=0.05"});
  EXPECT_THAT(NamesOf(found), ElementsAre("viscous_friction@elbow"));
  EXPECT_NEAR(ValueOf(found, "viscous_friction@elbow"), 0.05, 2e-4);
  EXPECT_LT(found.score, found.nothing.deviance - 100.0);
}

TEST(Explain, NamesAMotorThatIsWeak) {
  const Explained found = ExplainedFor({"motor_constant@motor1:factor=0.97"});
  EXPECT_THAT(NamesOf(found), ElementsAre("motor_constant@motor1"));
  EXPECT_NEAR(ValueOf(found, "motor_constant@motor1"), 0.97, 1e-3);
}

// Shapes of one resistance are one block: none of them stands beside another.
TEST(Explain, NamesDryFrictionOfTwoJointsOnceEach) {
  const Explained found = ExplainedFor(
      {"coulomb_friction@shoulder:force=0.2", "coulomb_friction@elbow:force=0.05"});
  EXPECT_THAT(NamesOf(found), UnorderedElementsAre("coulomb_friction@shoulder",
                                                   "coulomb_friction@elbow"));
  EXPECT_NEAR(ValueOf(found, "coulomb_friction@shoulder"), 0.2, 2e-3);
  EXPECT_NEAR(ValueOf(found, "coulomb_friction@elbow"), 0.05, 5e-4);
}

}  // namespace
}  // namespace mjdiag
