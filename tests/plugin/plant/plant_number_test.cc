#include "mjdiag/plugin/plant/plant_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/numbered_plant.h"

namespace mjdiag {
namespace {

using test::MessageOf;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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

std::vector<std::string> Names(const mjModel& model,
                               const std::vector<PlantNumber>& numbers) {
  std::vector<std::string> names;
  for (const PlantNumber& number : numbers) {
    names.push_back(PlantNumberName(model, number));
  }
  return names;
}

// Gain beside kp and kv would be their sum.
TEST(PlantNumber, IsListedOnceWhateverNamesItHas) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "gain")), ElementsAre("gain@volts"));
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "kp")),
              ElementsAre("kp@servo", "kp@drive"));
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "kv")), ElementsAre("kv@drive"));
  EXPECT_THAT(Names(*plant, PlantNumbers(*plant)),
              AllOf(Contains("tendon_stiffness@cable"),
                    Contains("tendon_damping@cable"), Contains("tendon_friction@rope"),
                    Not(Contains("ref@slide")), Not(Contains("centre_z@fore"))));
  // By its name it is found all the same.
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "gain@drive")),
              ElementsAre("gain@drive"));
}

TEST(PlantNumber, IsNoneOfAnElementThatHasNone) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  const auto message = [&](const std::string& name) {
    return MessageOf<InputError>([&] { FindPlantNumber(*plant, name); });
  };
  EXPECT_THAT(message("gain@push"), HasSubstr("it is gear@"));
  EXPECT_THAT(message("kp@volts"), HasSubstr("feeds back its position"));
  EXPECT_THAT(message("kv@servo"), HasSubstr("feeds back its velocity"));
  EXPECT_THAT(message("centre_x@world"), HasSubstr("a body with a mass"));
  const ModelPtr free = test::SmallPlant(test::kQuadrotor);
  EXPECT_THAT(MessageOf<InputError>([&] { FindPlantNumber(*free, "ref@base"); }),
              HasSubstr("a hinge or a slide"));
}

TEST(PlantNumber, OfNoKindIsAnsweredWithAllKinds) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  for (const auto& find :
       {+[](const mjModel& model) { FindPlantNumber(model, "solref@cable"); },
        +[](const mjModel& model) { PlantNumbersOf(model, "solref"); }}) {
    EXPECT_THAT(MessageOf<InputError>([&] { find(*plant); }),
                AllOf(HasSubstr("mass@"), HasSubstr("centre_z@ a body"),
                      HasSubstr("ref@ a joint"), HasSubstr("kv@ an actuator"),
                      HasSubstr("tendon_friction@ a tendon")));
  }
}

// No record tells it from an offset of an encoder: whoever wants it says so.
TEST(PlantNumber, IsAReferenceOnlyIfItIsAskedFor) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "ref")),
              ElementsAre("ref@shoulder", "ref@slide", "ref@elbow"));
  EXPECT_THAT(Names(*plant, PlantNumbersOf(*plant, "all")),
              Not(Contains("ref@shoulder")));
  const ModelPtr declares =
      test::SmallPlant(test::NumberedMjcf(test::kNumberedValues,
                                          R"(<custom><numeric name="known" data="0.3"/>
         <numeric name="known.ref@slide" data="0.01"/></custom>)"));
  EXPECT_THAT(Names(*declares, PlantNumbers(*declares)),
              AllOf(Contains("ref@slide"), Not(Contains("ref@elbow"))));
  EXPECT_EQ(DoubtOf(*declares, FindPlantNumber(*declares, "ref@slide")), 0.01);
  // 0.3 of what?
  EXPECT_EQ(SpreadOf(*declares, FindPlantNumber(*declares, "ref@elbow")), 2e-4);
}

TEST(PlantNumber, IsKnownAsItsPlantSaysOfItsKindButForThoseThatAreNamed) {
  const ModelPtr plant =
      test::SmallPlant(test::NumberedMjcf(test::kNumberedValues,
                                          R"(<custom><numeric name="known" data="0.3"/>
         <numeric name="known.damping" data="0.07"/>
         <numeric name="known.damping@shoulder" data="0.01"/></custom>)"));
  CheckKnownNumbers(*plant);
  EXPECT_EQ(SpreadOf(*plant, FindPlantNumber(*plant, "damping@shoulder")), 0.01);
  EXPECT_EQ(SpreadOf(*plant, FindPlantNumber(*plant, "damping@slide")), 0.07);
  EXPECT_EQ(DoubtOf(*plant, FindPlantNumber(*plant, "damping@slide")), 0.07);
  EXPECT_EQ(SpreadOf(*plant, FindPlantNumber(*plant, "armature@shoulder")), 0.3);
}

TEST(PlantNumber, IsKnownAsItsPlantSaysIfThatNamesOne) {
  const auto with = [](const std::string& name) {
    return test::SmallPlant(test::NumberedMjcf(
        test::kNumberedValues,
        "<custom><numeric name=\"known." + name + "\" data=\"0.04\"/></custom>"));
  };
  for (const auto& [name, value] : test::kNumberedValues) {
    const ModelPtr plant = with(name);
    CheckKnownNumbers(*plant);
    EXPECT_EQ(SpreadOf(*plant, FindPlantNumber(*plant, name)), 0.04) << name;
  }
  EXPECT_THAT(MessageOf<InputError>([&] { CheckKnownNumbers(*with("kp@volts")); }),
              AllOf(HasSubstr("known.kp@volts"), HasSubstr("none of that element")));
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
