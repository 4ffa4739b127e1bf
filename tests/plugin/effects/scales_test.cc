#include "mjdiag/plugin/effects/scales.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

Scales Machine() {
  return {.stroke = 0.2, .speed = 0.5, .force = 40.0, .mass = 3.0, .duration = 10.0};
}

TEST(MachineUnit, IsMadeOfTheMachinesOwnForceStrokeAndSpeed) {
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "N"), 40.0);
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "N s/m"), 40.0 / 0.5);
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "N s^2/m^2"), 40.0 / 0.25);
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "N/m^3"), 40.0 / 0.008);
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "1/N"), 1.0 / 40.0);
  EXPECT_DOUBLE_EQ(MachineUnit(Machine(), "kg"), 3.0);
  EXPECT_EQ(MachineUnit(Machine(), "1"), 1.0);
}

TEST(MachineUnit, IsAnythingWhereTheMachineHasNone) {
  EXPECT_TRUE(std::isinf(MachineUnit(Machine(), "Hz")));
  Scales still = Machine();
  still.stroke = 0.0;
  EXPECT_TRUE(std::isinf(MachineUnit(still, "N/m")));
}

// A spread of 0 would forbid what it is of.
TEST(Spread, OfEveryEffectHasAValueForEveryParameter) {
  for (const Effect* effect : Effects()) {
    const EffectValues spread = effect->Spread(Machine());
    ASSERT_EQ(spread.size(), std::ssize(effect->parameters())) << effect->name();
    EXPECT_GT(spread.minCoeff(), 0.0) << effect->name();
    EXPECT_GT(effect->odds(), 0.0) << effect->name();
    EXPECT_LE(effect->odds(), 1.0) << effect->name();
  }
}

}  // namespace
}  // namespace mjdiag
