#pragma once
// The stage of support/stage.h with what is to be discovered in a measurement of it.

#include "mjdiag/discovery/hypotheses/problem.h"
#include "support/stage.h"

namespace mjdiag::test {

struct StageUnderTest : Stage {
  DiscoveryProblem Pose(const Record& measured) const {
    return PoseProblem(machine, measured, 0.7, 0.0);
  }
};

}  // namespace mjdiag::test
