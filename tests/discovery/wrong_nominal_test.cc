// A healthy machine whose model is a little off: its numbers, and nothing else.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/plant/plant_number.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {
namespace {

TEST(WrongNominal, OfTheBonderIsItsNumbersAndNothingElse) {
  const Machine model{ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383", {})};
  const std::map<std::string, double> truth{
      {"mass@x_stage", 1.01}, {"damping@X", 1.08}, {"stiffness@u1", 1.05}};
  NumberFactors off;
  for (const auto& [name, factor] : truth) {
    off.emplace_back(FindPlantNumber(model.plant(), name), factor);
  }
  const Excitation motion =
      FollowTrajectory(model.setup(), model.setup().trajectories.Find("multi"));
  const Record record = Simulate(model.WithNumbers(off), motion, {});
  DiscoverOptions options;
  options.doubt = true;
  options.figures = false;
  options.budget = 30.0;
  const Discovery discovery = Discover(model, record, nullptr, options);
  EXPECT_TRUE(discovery.causes.empty());
  EXPECT_EQ(discovery.verdict, DiscoveryVerdict::kNoDiscrepancy);
  // The stage, its mounts and its motor together are as large as is known beforehand: no
  // motion tells that. What they are of each other the record does.
  const auto motor =
      std::ranges::find(discovery.calibration, "gear@x_motor", &CalibratedNumber::name);
  ASSERT_NE(motor, discovery.calibration.end());
  int outside = 0;
  for (const CalibratedNumber& number : discovery.calibration) {
    const auto known = truth.find(number.name);
    const double factor = known == truth.end() ? 1.0 : known->second;
    outside += number.low <= factor && factor <= number.high ? 0 : 1;
    if (known == truth.end()) continue;
    EXPECT_NEAR(number.factor / motor->factor, factor, 2e-3) << number.name;
  }
  EXPECT_EQ(discovery.calibration.size(), 32u);
  // Of 32 intervals of 95 %, independent ones, more than 5 with a probability of 0.4 %.
  EXPECT_LE(outside, 5);
}

}  // namespace
}  // namespace mjdiag
