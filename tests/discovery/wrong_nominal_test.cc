// A healthy machine whose model is a little off: its numbers, and nothing else.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

TEST(WrongNominal, OfTheBonderIsItsNumbersAndNothingElse) {
  const Machine model = test::Bonder().WithSubsteps(2);
  const std::map<std::string, double> truth{{"mass@x_stage", 1.01},
                                            {"damping@X", 1.08}};
  NumberFactors off;
  for (const auto& [name, factor] : truth) {
    off.emplace_back(FindModelParameter(model.plant(), name), factor);
  }
  Trajectory motion = model.setup().trajectories.Find("multi");
  motion.duration = 0.25;
  const Record record =
      Simulate(model.WithNumbers(off), FollowTrajectory(model.setup(), motion), {});
  DiscoverOptions options;
  options.doubt = true;
  options.figures = false;
  const Discovery discovery = Discover(model, record, nullptr, options);
  // A damper with a fault parameter is said by its name.
  ASSERT_EQ(discovery.causes.size(), 1u);
  EXPECT_EQ(discovery.causes[0].cause.name(), "zeta_x");
  EXPECT_NEAR(discovery.causes[0].parameters.at(0).value, truth.at("damping@X"), 2e-3);
  EXPECT_EQ(discovery.verdict, DiscoveryVerdict::kExplained);
  ASSERT_EQ(discovery.calibration.size(), 1u);
  EXPECT_EQ(discovery.calibration[0].name, "mass@x_stage");
  EXPECT_NEAR(discovery.calibration[0].factor, truth.at("mass@x_stage"), 2e-3);
}

}  // namespace
}  // namespace mjdiag
