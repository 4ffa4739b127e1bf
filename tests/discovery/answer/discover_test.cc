#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

DiscoverOptions WithDoubt() {
  DiscoverOptions options;
  options.doubt = true;
  return options;
}

const Discovery& Friction() {
  static const Discovery found = [] {
    const test::Arm arm;
    const Record record =
        test::Arm::Measure({"coulomb_friction@elbow:force=0.05"}, 1.0, 64);
    return Discover(arm.machine, record, nullptr, WithDoubt());
  }();
  return found;
}

TEST(Answer, SaysACauseWithItsValueAndItsKind) {
  const Discovery& answer = Friction();
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kExplained);
  ASSERT_THAT(answer.causes, SizeIs(1));
  const FoundCause& found = answer.causes.front();
  EXPECT_EQ(found.cause.name(), "coulomb_friction");
  EXPECT_EQ(found.cause.site, "elbow");
  ASSERT_THAT(found.parameters, SizeIs(1));
  const CauseParameter& force = found.parameters.front();
  EXPECT_EQ(force.unit, "N m");
  EXPECT_NEAR(force.value, 0.05, 4.0 * force.sd + 1e-4);
  EXPECT_LT(force.low, force.value);
  EXPECT_GT(force.high, force.value);
  ASSERT_THAT(answer.kinds, Not(IsEmpty()));
  EXPECT_EQ(answer.kinds.front().kind, Kind::kDryFriction);
  EXPECT_GE(answer.kinds.front().probability, found.probability);
  EXPECT_GT(answer.kinds.front().share, 0.9);
}

TEST(Answer, PredictsUnseenDataBetterAndSaysByHowMuch) {
  const Discovery& answer = Friction();
  EXPECT_GT(answer.gain_train, 0.9);
  EXPECT_GT(answer.gain_validation, 0.9);
  ASSERT_THAT(answer.ladder, SizeIs(2));
  EXPECT_GT(answer.ladder[0].held_out, 3.0);
  EXPECT_NEAR(answer.ladder[1].held_out, 1.0, 0.2);
  EXPECT_LT(answer.colour_after, answer.colour_before);
}

TEST(Answer, DrawsTheForceThatIsMissingAndTheLaw) {
  const Discovery& answer = Friction();
  ASSERT_EQ(answer.forces_before.size(), answer.forces_after.size());
  ASSERT_THAT(answer.forces_before, Not(IsEmpty()));
  ASSERT_THAT(answer.laws, SizeIs(1));
  EXPECT_EQ(answer.laws.front().site, "elbow");
  EXPECT_EQ(answer.laws.front().x_unit, "rad/s");
}

TEST(Answer, SaysWhatWasTried) {
  EXPECT_THAT(Friction().decisions, Not(IsEmpty()));
  EXPECT_EQ(Friction().decisions.back().why.empty(), false);
}

/// Beside a model that has the forearm a tenth too light.
Discovery Heavy(const DiscoverOptions& options) {
  const test::Arm arm;
  const Machine light = arm.machine.WithNumbers(
      {{FindModelParameter(arm.machine.plant(), "mass@fore"), 1.0 / 1.1}});
  return Discover(light, test::Arm::Measure({}, 1.0, 64), nullptr, options);
}

TEST(Answer, WritesEveryNumberThatDiffersIntoTheExtendedPlant) {
  DiscoverOptions options = WithDoubt();
  options.figures = false;
  const Discovery answer = Heavy(options);
  const Changes changes = ChangesOfAnswer(answer);
  for (const CalibratedNumber& number : answer.calibration) {
    EXPECT_TRUE(IsOff(number)) << number.name;
    EXPECT_TRUE(std::ranges::any_of(changes.numbers, [&](const auto& one) {
      return one.first == number.number && one.second == number.factor;
    })) << number.name;
  }
  EXPECT_TRUE(HasFound(answer));
}

TEST(Answer, TakesNumbersAsTheyAreWithoutDoubt) {
  DiscoverOptions options;
  options.figures = false;
  EXPECT_THAT(Heavy(options).calibration, IsEmpty());
}

TEST(Answer, NamesNothingThatWasNotChosen) {
  DiscoverOptions options = WithDoubt();
  options.choice.only = {"viscous_friction"};
  options.figures = false;
  for (const FoundCause& found : Heavy(options).causes) {
    EXPECT_EQ(found.cause.name(), "viscous_friction");
  }
}

TEST(Answer, NamesNoMoreCausesThanItMay) {
  const test::Arm arm;
  const Record record = test::Arm::Measure(
      {"coulomb_friction@shoulder:force=0.2", "coulomb_friction@elbow:force=0.05"}, 1.0,
      64);
  DiscoverOptions options;
  options.most_causes = 1;
  options.figures = false;
  EXPECT_THAT(Discover(arm.machine, record, nullptr, options).causes, SizeIs(1));
}

}  // namespace
}  // namespace mjdiag
