// Two laws on different axes of the wire bonder, each thousands of times what its encoders
// see, through the same door as people. The machine has finer physics steps than the model:
// what these are off by is no law, though it is hundreds of times the noise, too.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {
namespace {

TEST(BonderSets, ASealAndARippleAreNamedTogetherAndNothingElse) {
  const Machine model{ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383", {})};
  Trajectory motion = model.setup().trajectories.Find("multi");
  motion.duration = 0.7;
  Changes hidden;
  hidden.effects = {ParseEffect("coulomb_friction@Z:force=0.004"),
                    ParseEffect("force_ripple@X:amplitude=0.8,period=0.0024,phase=1")};
  const Machine machine = model.WithSubsteps(2 * model.rates().substeps).With(hidden);
  const Record record = Simulate(machine, FollowTrajectory(model.setup(), motion), {});
  DiscoverOptions options;
  options.figures = false;
  options.budget = 120.0;
  const Discovery discovery = Discover(model, record, nullptr, options);
  std::map<std::string, Eigen::VectorXd> found;
  for (const FoundCause& cause : discovery.causes) {
    found[cause.cause.name() + "@" + cause.cause.site] = cause.cause.values;
  }
  ASSERT_EQ(found.size(), 2u);
  ASSERT_TRUE(found.contains("coulomb_friction@Z"));
  ASSERT_TRUE(found.contains("force_ripple@X"));
  EXPECT_NEAR(found["coulomb_friction@Z"][0], 0.004, 1e-6);
  EXPECT_NEAR(found["force_ripple@X"][0], 0.8, 1e-3);
  EXPECT_NEAR(found["force_ripple@X"][1], 0.0024, 1e-6);
  EXPECT_EQ(discovery.verdict, DiscoveryVerdict::kExplained);
}

}  // namespace
}  // namespace mjdiag
