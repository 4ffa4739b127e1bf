// Models of what a machine lacks.

#include "mjdiag/discovery/fit/model.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

Block BlockOf(const std::string& name, double extent) {
  Candidate candidate{
      .effect = Lasting(FindEffect(name)), .site = "j", .parameters = {}};
  for (const EffectParameter& one : candidate.effect->parameters()) {
    FitParameter parameter{one.name, one.role, one.minimum, one.maximum};
    parameter.extent = extent;
    candidate.parameters.push_back(parameter);
  }
  Block block;
  block.name = name + "@j";
  block.candidate = candidate;
  return block;
}

VectorXd Values(double a, double b, double c) { return Eigen::Vector3d(a, b, c); }

// 10 s show waves 0.1 Hz apart, a stroke of 0.2 m a whole period more of it.
TEST(Model, TellsWavesApartByATurnOfTheirPhase) {
  const std::vector<Block> vibration{BlockOf("floor_vibration", 10.0)};
  EXPECT_TRUE(IsResolved(vibration, {{0, Values(1, 5.0, 0)}, {0, Values(1, 5.11, 0)}}));
  EXPECT_FALSE(
      IsResolved(vibration, {{0, Values(1, 5.0, 0)}, {0, Values(2, 5.09, 1)}}));
  const std::vector<Block> ripple{BlockOf("force_ripple", 0.2)};
  EXPECT_TRUE(IsResolved(ripple, {{0, Values(1, 0.2, 0)}, {0, Values(1, 0.099, 0)}}));
  EXPECT_FALSE(IsResolved(ripple, {{0, Values(1, 0.2, 0)}, {0, Values(1, 0.11, 0)}}));
}

TEST(Model, TellsResonancesApartByTheirWidths) {
  const std::vector<Block> modes{BlockOf("flexible_mode", 0.0)};
  EXPECT_TRUE(
      IsResolved(modes, {{0, Values(1, 13.0, 0.02)}, {0, Values(1, 13.6, 0.02)}}));
  EXPECT_FALSE(
      IsResolved(modes, {{0, Values(1, 13.0, 0.02)}, {0, Values(1, 13.5, 0.02)}}));
}

TEST(Model, TellsWhatIsNoWaveApart) {
  const std::vector<Block> blocks{BlockOf("end_stop", 0.0),
                                  BlockOf("floor_vibration", 10.0),
                                  BlockOf("floor_vibration", 10.0)};
  const VectorXd stop = Eigen::Vector2d(0.1, 100.0);
  EXPECT_TRUE(IsResolved(blocks, {{0, stop}, {0, stop}}));
  EXPECT_TRUE(IsResolved(blocks, {{1, Values(1, 5, 0)}, {2, Values(1, 5, 0)}}));
}

}  // namespace
}  // namespace mjdiag
