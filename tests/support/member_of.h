#pragma once
// A member of a model by the name of its block, "viscous_friction@elbow".

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mjdiag/discovery/fit/model.h"

namespace mjdiag::test {

inline Member MemberOf(const std::vector<Block>& blocks, const std::string& name,
                       const Eigen::VectorXd& values) {
  const auto found = std::ranges::find(blocks, name, &Block::name);
  EXPECT_NE(found, blocks.end()) << name;
  return {static_cast<std::size_t>(found - blocks.begin()), values};
}

}  // namespace mjdiag::test
