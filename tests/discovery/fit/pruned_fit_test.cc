// What a fit has made nothing of.

#include "mjdiag/discovery/fit/pruned_fit.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

Block FrictionAt(const std::string& site, double price) {
  Candidate candidate{.effect = Lasting(FindEffect("coulomb_friction")),
                      .site = site,
                      .parameters = {}};
  FitParameter force{"force", Role::kAmplitude, 0.0, 10.0};
  force.spread = 2.0;
  candidate.parameters.push_back(force);
  Block block;
  block.name = "coulomb_friction@" + site;
  block.candidate = candidate;
  block.price = price;
  return block;
}

// Without a fit, for which there may be no time.
TEST(PrunedFit, LeavesOutWhatHasNoSizeWithItsPrice) {
  const std::vector<Block> blocks{FrictionAt("a", 20.0), FrictionAt("b", 30.0)};
  ModelFit fit{{{0, VectorXd::Constant(1, 0.0)}, {1, VectorXd::Constant(1, 0.5)}},
               Eigen::Vector2d(0.1, 0.2),
               50.0,
               0.0,
               7.0};
  fit = WithoutIdle(blocks, fit);
  ASSERT_EQ(fit.model.size(), 1u);
  EXPECT_EQ(fit.model[0].block, 1u);
  ASSERT_EQ(fit.sd.size(), 1);
  EXPECT_EQ(fit.sd[0], 0.2);
  EXPECT_EQ(fit.prior, 30.0);
  EXPECT_EQ(fit.deviance, 7.0);
}

}  // namespace
}  // namespace mjdiag
