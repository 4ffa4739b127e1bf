#include "mjdiag/plugin/plant/model_parameter.h"

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

TEST(ModelParameter, IsFoundByItsName) {
  const Machine bonder = test::Bonder();
  for (const ModelParameter& number : ModelParameters(bonder.plant())) {
    EXPECT_EQ(
        FindModelParameter(bonder.plant(), ModelParameterName(bonder.plant(), number)),
        number);
  }
  EXPECT_THROW(FindModelParameter(bonder.plant(), "colour@X"), InputError);
  EXPECT_THROW(FindModelParameter(bonder.plant(), "damping@nowhere"), InputError);
}

TEST(ModelParameter, OfAPlantThatSaysSoIsExact) {
  const Machine bonder = test::Bonder();
  EXPECT_TRUE(IsExact(bonder.plant()));
  for (const ModelParameter& number : ModelParameters(bonder.plant())) {
    EXPECT_EQ(SpreadOf(bonder.plant(), number), 0.0);
  }
}

TEST(ModelParameter, IsElseKnownAsItsKindUsuallyIs) {
  const Machine stage(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"));
  EXPECT_FALSE(IsExact(stage.plant()));
  for (const ModelParameter& number : ModelParameters(stage.plant())) {
    EXPECT_EQ(SpreadOf(stage.plant(), number), UsualSpread(number.kind));
  }
}

// Without a bias the gear says the same.
TEST(ModelParameter, IsAGainOfMotorsWithABiasOnly) {
  const Machine bonder = test::Bonder();
  EXPECT_THROW(ModelParametersOf(bonder.plant(), "gain"), InputError);
  const Machine servo(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"));
  EXPECT_EQ(ModelParametersOf(servo.plant(), "gain").size(), 1u);
  EXPECT_EQ(ModelParametersOf(servo.plant(), "armature").size(), 1u);
}

std::vector<std::string> Names(const mjModel& model,
                               const std::vector<ModelParameter>& numbers) {
  std::vector<std::string> names;
  for (const ModelParameter& number : numbers) {
    names.push_back(ModelParameterName(model, number));
  }
  return names;
}

// Gain beside kp and kv would be their sum.
TEST(ModelParameter, IsListedOnceWhateverNamesItHas) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "gain")),
              ElementsAre("gain@volts"));
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "kp")),
              ElementsAre("kp@servo", "kp@drive"));
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "kv")), ElementsAre("kv@drive"));
  EXPECT_THAT(Names(*plant, ModelParameters(*plant)),
              AllOf(Contains("tendon_stiffness@cable"),
                    Contains("tendon_damping@cable"), Contains("tendon_friction@rope"),
                    Not(Contains("ref@slide")), Not(Contains("centre_z@fore"))));
  // By its name it is found all the same.
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "gain@drive")),
              ElementsAre("gain@drive"));
}

TEST(ModelParameter, IsNoneOfAnElementThatHasNone) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  const auto message = [&](const std::string& name) {
    return MessageOf<InputError>([&] { FindModelParameter(*plant, name); });
  };
  EXPECT_THAT(message("gain@push"), HasSubstr("it is gear@"));
  EXPECT_THAT(message("kp@volts"), HasSubstr("feeds back its position"));
  EXPECT_THAT(message("kv@servo"), HasSubstr("feeds back its velocity"));
  EXPECT_THAT(message("centre_x@world"), HasSubstr("a body with a mass"));
  const ModelPtr free = test::SmallPlant(test::kQuadrotor);
  EXPECT_THAT(MessageOf<InputError>([&] { FindModelParameter(*free, "ref@base"); }),
              HasSubstr("a hinge or a slide"));
}

TEST(ModelParameter, OfNoKindIsAnsweredWithAllKinds) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  for (const auto& find :
       {+[](const mjModel& model) { FindModelParameter(model, "solref@cable"); },
        +[](const mjModel& model) { ModelParametersOf(model, "solref"); }}) {
    EXPECT_THAT(MessageOf<InputError>([&] { find(*plant); }),
                AllOf(HasSubstr("mass@"), HasSubstr("centre_z@ a body"),
                      HasSubstr("ref@ a joint"), HasSubstr("kv@ an actuator"),
                      HasSubstr("tendon_friction@ a tendon")));
  }
}

// No record tells it from an offset of an encoder: whoever wants it says so.
TEST(ModelParameter, IsAReferenceOnlyIfItIsAskedFor) {
  const ModelPtr plant = test::SmallPlant(test::NumberedMjcf());
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "ref")),
              ElementsAre("ref@shoulder", "ref@slide", "ref@elbow"));
  EXPECT_THAT(Names(*plant, ModelParametersOf(*plant, "all")),
              Not(Contains("ref@shoulder")));
  const ModelPtr declares =
      test::SmallPlant(test::NumberedMjcf(test::kNumberedValues,
                                          R"(<custom><numeric name="known" data="0.3"/>
         <numeric name="known.ref@slide" data="0.01"/></custom>)"));
  EXPECT_THAT(Names(*declares, ModelParameters(*declares)),
              AllOf(Contains("ref@slide"), Not(Contains("ref@elbow"))));
  EXPECT_EQ(DoubtOf(*declares, FindModelParameter(*declares, "ref@slide")), 0.01);
  // 0.3 of what?
  EXPECT_EQ(SpreadOf(*declares, FindModelParameter(*declares, "ref@elbow")), 2e-4);
}

TEST(ModelParameter, IsKnownAsItsPlantSaysOfItsKindButForThoseThatAreNamed) {
  const ModelPtr plant =
      test::SmallPlant(test::NumberedMjcf(test::kNumberedValues,
                                          R"(<custom><numeric name="known" data="0.3"/>
         <numeric name="known.damping" data="0.07"/>
         <numeric name="known.damping@shoulder" data="0.01"/></custom>)"));
  CheckKnownNumbers(*plant);
  EXPECT_EQ(SpreadOf(*plant, FindModelParameter(*plant, "damping@shoulder")), 0.01);
  EXPECT_EQ(SpreadOf(*plant, FindModelParameter(*plant, "damping@slide")), 0.07);
  EXPECT_EQ(DoubtOf(*plant, FindModelParameter(*plant, "damping@slide")), 0.07);
  EXPECT_EQ(SpreadOf(*plant, FindModelParameter(*plant, "armature@shoulder")), 0.3);
}

TEST(ModelParameter, IsKnownAsItsPlantSaysIfThatNamesOne) {
  const auto with = [](const std::string& name) {
    return test::SmallPlant(test::NumberedMjcf(
        test::kNumberedValues,
        "<custom><numeric name=\"known." + name + "\" data=\"0.04\"/></custom>"));
  };
  for (const auto& [name, value] : test::kNumberedValues) {
    const ModelPtr plant = with(name);
    CheckKnownNumbers(*plant);
    EXPECT_EQ(SpreadOf(*plant, FindModelParameter(*plant, name)), 0.04) << name;
  }
  EXPECT_THAT(MessageOf<InputError>([&] { CheckKnownNumbers(*with("kp@volts")); }),
              AllOf(HasSubstr("known.kp@volts"), HasSubstr("none of that element")));
}

TEST(ModelParameter, ScalesTheMachine) {
  const Machine bonder = test::Bonder();
  const ModelParameter mass = FindModelParameter(bonder.plant(), "mass@y_stage");
  const Machine heavier = bonder.WithNumbers({{mass, 1.01}});
  const double added =
      heavier.plant().body_mass[mass.element] - bonder.plant().body_mass[mass.element];
  EXPECT_NEAR(added, 0.01 * bonder.plant().body_mass[mass.element], 1e-12);
  EXPECT_GT((heavier.linear().M - bonder.linear().M).norm(), 0.0);
}

}  // namespace
}  // namespace mjdiag
