// What a discovery says of numbers of the plant that are far from what was known of them,
// and of what is no more than the steps of the simulation.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

Discovery InDoubt(const test::Stage& stage, const Record& record) {
  DiscoverOptions options;
  options.figures = false;
  options.doubt = true;
  options.choice.only = {"coulomb_friction", "force_offset"};
  return Discover(stage.machine, record, nullptr, options);
}

TEST(FarNumbers, AreSaidWithHowFarTheyAre) {
  const test::Stage stage;
  // A mass and a motor constant are known to 5 %, and share it: five of that each.
  const Record record = stage.Measure({}, {{"eta", std::exp(-0.5)}});
  const Discovery discovery = InDoubt(stage, record);
  EXPECT_THAT(discovery.notes, Contains(HasSubstr("times what the plant says")));
  EXPECT_THAT(discovery.notes, Contains(HasSubstr("say how well it is known (known.")));
}

TEST(FarNumbers, AreNotSaidOfANumberThatIsOffAsNumbersAre) {
  const test::Stage stage;
  const Record record = stage.Measure({}, {{"eta", 0.97}});
  EXPECT_THAT(InDoubt(stage, record).notes,
              Not(Contains(HasSubstr("times what the plant says"))));
}

Discovery OfDelay(const test::Stage& stage, double steps) {
  const double delay = steps * stage.machine.plant().opt.timestep;
  const Record record =
      stage.Measure({"input_delay@drive:delay=" + std::to_string(delay)});
  DiscoverOptions options;
  options.figures = false;
  options.choice.only = {"input_delay"};
  return Discover(stage.machine, record, nullptr, options);
}

TEST(StepsOfTheSimulation, AreNoCause) {
  const test::Stage stage;
  const Discovery half = OfDelay(stage, 0.5);
  EXPECT_TRUE(half.causes.empty());
  EXPECT_EQ(half.verdict, DiscoveryVerdict::kNoDiscrepancy);
  EXPECT_THAT(half.notes, Contains(HasSubstr("later than in the simulation")));
  const Discovery late = OfDelay(stage, 3.0);
  ASSERT_EQ(late.causes.size(), 1u);
  EXPECT_EQ(late.causes[0].cause.name(), "input_delay");
}

}  // namespace
}  // namespace mjdiag
