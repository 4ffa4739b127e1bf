#include "mjdiag/plugin/plant/plant_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

TEST(PlantNumber, IsFoundByItsName) {
  const Machine bonder = test::Bonder();
  for (const PlantNumber& number : PlantNumbers(bonder.plant())) {
    EXPECT_EQ(FindPlantNumber(bonder.plant(), PlantNumberName(bonder.plant(), number)),
              number);
  }
  EXPECT_THROW(FindPlantNumber(bonder.plant(), "colour@X"), InputError);
  EXPECT_THROW(FindPlantNumber(bonder.plant(), "damping@nowhere"), InputError);
}

TEST(PlantNumber, OfAPlantThatSaysSoIsExact) {
  const Machine bonder = test::Bonder();
  EXPECT_TRUE(IsExact(bonder.plant()));
  for (const PlantNumber& number : PlantNumbers(bonder.plant())) {
    EXPECT_EQ(SpreadOf(bonder.plant(), number), 0.0);
  }
}

TEST(PlantNumber, IsElseKnownAsItsKindUsuallyIs) {
  const Machine stage(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"));
  EXPECT_FALSE(IsExact(stage.plant()));
  for (const PlantNumber& number : PlantNumbers(stage.plant())) {
    EXPECT_EQ(SpreadOf(stage.plant(), number), UsualSpread(number.kind));
  }
}

// Without a bias the gear says the same.
TEST(PlantNumber, IsAGainOfMotorsWithABiasOnly) {
  const Machine bonder = test::Bonder();
  EXPECT_THROW(PlantNumbersOf(bonder.plant(), "gain"), InputError);
  const Machine servo(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"));
  EXPECT_EQ(PlantNumbersOf(servo.plant(), "gain").size(), 1u);
  EXPECT_EQ(PlantNumbersOf(servo.plant(), "armature").size(), 1u);
}

TEST(PlantNumber, ScalesTheMachine) {
  const Machine bonder = test::Bonder();
  const PlantNumber mass = FindPlantNumber(bonder.plant(), "mass@y_stage");
  const Machine heavier = bonder.WithNumbers({{mass, 1.01}});
  const double added =
      heavier.plant().body_mass[mass.element] - bonder.plant().body_mass[mass.element];
  EXPECT_NEAR(added, 0.01 * bonder.plant().body_mass[mass.element], 1e-12);
  EXPECT_GT((heavier.linear().M - bonder.linear().M).norm(), 0.0);
}

}  // namespace
}  // namespace mjdiag
