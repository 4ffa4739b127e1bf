// Friction with bristles in a measurement of the stage is found under its own name.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

/// Of the friction laws, what is found for that one.
void ExpectFound(const std::string& spec) {
  const test::Stage stage(2000.0);  // bristles are short
  const PlacedEffect truth = ParseEffect(spec);
  DiscoverOptions options;
  options.choice.only = {"friction"};
  const Discovery answer =
      Discover(stage.machine, stage.Measure({spec}), nullptr, options);
  std::string names;
  for (const FoundCause& one : answer.causes) names += one.cause.name() + " ";
  ASSERT_EQ(answer.causes.size(), 1u) << names;
  EXPECT_EQ(answer.causes[0].cause.name(), truth.name());
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kExplained);
  Eigen::Index i = 0;
  for (const CauseParameter& parameter : answer.causes[0].parameters) {
    // Four standard deviations, by the 95 % interval, and what fits end within.
    const double half = 0.5 * (parameter.high - parameter.low);
    const double value = truth.values[i++];
    EXPECT_NEAR(parameter.value, value, 4.0 / 1.96 * half + 1e-3 * value)
        << parameter.name;
    EXPECT_LT(half, 0.1 * parameter.value) << parameter.name;
  }
}

TEST(BristleDiscovery, FindsLugreFriction) {
  ExpectFound(
      "lugre_friction@load:coulomb=6,breakaway=4,velocity=0.02,stiffness=4000,"
      "damping=60");
}

TEST(BristleDiscovery, FindsThePreslidingFrictionOfAGear) {
  ExpectFound(
      "presliding_gear_friction@load:driving=0.15,backdriving=0.06,length=0.003");
}

}  // namespace
}  // namespace mjdiag
