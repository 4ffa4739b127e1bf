#include "mjdiag/discovery/explanations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/effects/placed_effect.h"

namespace mjdiag {
namespace {

using ::testing::IsEmpty;

FoundCause Found(const std::string& effect, double probability,
                 const std::vector<Alternative>& alternatives = {}) {
  FoundCause found;
  found.cause = ParseEffect(effect);
  found.probability = probability;
  found.alternatives = alternatives;
  return found;
}

const char* const kFriction = "coulomb_friction@load:force=20";
const char* const kRipple = "force_ripple@load:amplitude=1,period=0.01";
const char* const kDrag = "quadratic_drag@load:coefficient=3";
const char* const kDamping = "viscous_friction@load:coefficient=3";
const char* const kStiffness = "cubic_stiffness@load:coefficient=3";

TEST(Explanations, AreNoneWhereNothingIsNamed) {
  EXPECT_THAT(ExplanationsOf({}), IsEmpty());
}

TEST(Explanations, AreOneWhereNothingElseSurvives) {
  const auto sets = ExplanationsOf({Found(kFriction, 1.0), Found(kRipple, 1.0)});
  ASSERT_EQ(sets.size(), 1u);
  EXPECT_EQ(sets[0].probability, 1.0);
  ASSERT_EQ(sets[0].causes.size(), 2u);
  EXPECT_EQ(sets[0].causes[1].name(), "force_ripple");
}

TEST(Explanations, ExchangeOneCauseAtATime) {
  const auto sets = ExplanationsOf(
      {Found(kFriction, 0.8, {{ParseEffect(kDrag), 0.2}}),
       Found(kRipple, 0.5,
             {{ParseEffect(kStiffness), 0.4}, {ParseEffect(kDamping), 0.1}})});
  // As likely as 1, 0.2 / 0.8, 0.4 / 0.5, 0.1 / 0.5.
  ASSERT_EQ(sets.size(), 4u);
  const double sum = 1.0 + 0.25 + 0.8 + 0.2;
  EXPECT_NEAR(sets[0].probability, 1.0 / sum, 1e-12);
  EXPECT_NEAR(sets[1].probability, 0.8 / sum, 1e-12);
  EXPECT_NEAR(sets[2].probability, 0.25 / sum, 1e-12);
  EXPECT_NEAR(sets[3].probability, 0.2 / sum, 1e-12);
  EXPECT_EQ(sets[1].causes[0].name(), "coulomb_friction");
  EXPECT_EQ(sets[1].causes[1].name(), "cubic_stiffness");
  EXPECT_EQ(sets[2].causes[0].name(), "quadratic_drag");
  EXPECT_EQ(sets[2].causes[1].name(), "force_ripple");
}

TEST(Explanations, BeginWithTheLikeliestWhicheverIsNamed) {
  const auto sets =
      ExplanationsOf({Found(kFriction, 0.3, {{ParseEffect(kDrag), 0.7}})});
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0].causes[0].name(), "quadratic_drag");
  EXPECT_NEAR(sets[0].probability, 0.7, 1e-12);
}

TEST(Explanations, ThatNothingTellsApartAreEquallyLikely) {
  const auto sets =
      ExplanationsOf({Found(kFriction, 0.6, {{ParseEffect(kDamping), 0.6, true}})});
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0].probability, sets[1].probability);
}

TEST(Explanations, HaveNoCauseTwice) {
  const auto sets = ExplanationsOf(
      {Found(kFriction, 0.6, {{ParseEffect(kRipple), 0.4}}), Found(kRipple, 1.0)});
  ASSERT_EQ(sets.size(), 1u);
  EXPECT_EQ(sets[0].probability, 1.0);
}

TEST(Explanations, OfLessThanOnePercentOrBeyondEightAreLeftOut) {
  EXPECT_EQ(
      ExplanationsOf({Found(kFriction, 0.995, {{ParseEffect(kDrag), 0.005}})}).size(),
      1u);
  std::vector<Alternative> many;
  for (int i = 0; i < 12; ++i) {
    many.push_back(
        {ParseEffect("viscous_friction@j" + std::to_string(i) + ":coefficient=3"),
         0.05});
  }
  const auto sets = ExplanationsOf({Found(kFriction, 0.4, many)});
  EXPECT_EQ(sets.size(), 8u);
  EXPECT_NEAR(sets[0].probability, 0.4, 1e-12);
}

}  // namespace
}  // namespace mjdiag
