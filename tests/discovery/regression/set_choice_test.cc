#include "mjdiag/discovery/regression/set_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

/// In the physics steps of the model.
ChosenSet ChosenFor(const std::vector<std::string>& lacking) {
  const test::Arm arm;
  const MeasuredRun run =
      ToMeasuredRun(arm.setup(), test::Arm::Measure(lacking, 1.0, 2));
  const FilterPath path = FilterLikeliest(
      arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise));
  std::vector<Candidate> candidates = ListCandidates(arm.machine);
  BoundByRecord(candidates, arm.machine, MotionAlong(arm.machine, run, path));
  return ChooseSet(arm.machine, run, path, candidates, {});
}

std::vector<std::string> NamesOf(const ChosenSet& chosen) {
  std::vector<std::string> names;
  for (const ChosenMember& member : chosen.members) {
    names.push_back(chosen.blocks[member.variation.block].name);
  }
  return names;
}

TEST(SetChoice, HasNothingWhereNothingIsHidden) {
  EXPECT_THAT(NamesOf(ChosenFor({})), IsEmpty());
}

// What is left of second order about the plant as given is another round's.
TEST(SetChoice, NamesADamperAndItsSize) {
  const ChosenSet chosen = ChosenFor({"viscous_friction@elbow:coefficient=0.05"});
  ASSERT_FALSE(chosen.members.empty());
  ASSERT_EQ(NamesOf(chosen).front(), "viscous_friction@elbow");
  const ChosenMember& member = chosen.members.front();
  const TrialValues values = member.variation.values(member.amplitudes);
  ASSERT_TRUE(values);
  EXPECT_NEAR((*values)[0], 0.05, 0.002);
  EXPECT_LT(chosen.score, chosen.score_of_nothing - 100.0);
}

TEST(SetChoice, NamesAMotorThatIsWeak) {
  const ChosenSet chosen = ChosenFor({"motor_constant@motor1:factor=0.97"});
  ASSERT_THAT(NamesOf(chosen), SizeIs(1));
  EXPECT_EQ(NamesOf(chosen).front(), "motor_constant@motor1");
}

}  // namespace
}  // namespace mjdiag
