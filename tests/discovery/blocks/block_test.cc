// Blocks: what a machine may lack, and which values of it there may be.

#include "mjdiag/discovery/blocks/block.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

// What is known to a tenth may be off by nine of them; at the end of that it would be further
// off still, if it might.
TEST(Block, HasNoNumberAtTheEndOfWhatIsKnown) {
  Block mass;
  mass.name = "mass@arm";
  mass.doubt = 0.1;
  const auto is_allowed = [&](double logarithm) {
    return IsAllowed(mass, Eigen::VectorXd::Constant(1, std::exp(logarithm)));
  };
  EXPECT_TRUE(is_allowed(0.89));
  EXPECT_TRUE(is_allowed(-0.89));
  EXPECT_FALSE(is_allowed(kFarthest * 0.1));
  EXPECT_FALSE(is_allowed(-kFarthest * 0.1));
}

}  // namespace
}  // namespace mjdiag
