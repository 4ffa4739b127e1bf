// Blocks: what a machine may lack, and which values of it there may be.

#include "mjdiag/discovery/blocks/block.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

// What is known to a tenth may be off by nine of them.
TEST(Block, KnowsANumberAtTheEndOfWhatIsKnown) {
  Block mass;
  mass.name = "mass@arm";
  mass.doubt = 0.1;
  for (const double sign : {-1.0, 1.0}) {
    const auto at = [&](double logarithm) {
      return Eigen::VectorXd::Constant(1, std::exp(sign * logarithm)).eval();
    };
    EXPECT_FALSE(IsAtItsEnd(mass, at(0.89)));
    EXPECT_TRUE(IsAtItsEnd(mass, at(kFarthest * 0.1)));
    EXPECT_TRUE(IsAllowed(mass, at(kFarthest * 0.1)));
    EXPECT_FALSE(IsAllowed(mass, at(0.91)));
  }
}

}  // namespace
}  // namespace mjdiag
