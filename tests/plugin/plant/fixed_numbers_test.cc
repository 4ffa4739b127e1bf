// What no record can say is said.

#include "mjdiag/plugin/plant/fixed_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/bonder.h"
#include "support/numbered_plant.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;

TEST(FixedNumbers, AreNamedWhereAPlantHasThem) {
  EXPECT_THAT(FixedNumbers(*test::SmallPlant(test::Gantry(1.0))),
              ElementsAre("solref and solimp of equality 'equality 0'"));
  EXPECT_THAT(FixedNumbers(*test::SmallPlant(test::kHopper)),
              ElementsAre("friction, solref and solimp of contacts"));
  EXPECT_THAT(FixedNumbers(*test::SmallPlant(test::NumberedMjcf())),
              ElementsAre("springlength of tendon 'cable'"));
  EXPECT_THAT(
      FixedNumbers(*test::SmallPlant(R"(<worldbody><body><joint name="j" type="slide"/>
        <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
        <actuator><general name="valve" joint="j" dyntype="filter" dynprm="0.1"/>
        <general name="tap" joint="j" dyntype="filter" dynprm="0.1"/></actuator>)")),
      ElementsAre("dynprm of 2 actuators"));
}

TEST(FixedNumbers, AreNothingToSayOfAPlantWithoutThem) {
  EXPECT_EQ(NoteOfFixedNumbers(test::Bonder().plant()), "");
  EXPECT_EQ(NoteOfFixedNumbers(*test::SmallPlant(test::kHopper)),
            "never in doubt: friction, solref and solimp of contacts");
}

}  // namespace
}  // namespace mjdiag
