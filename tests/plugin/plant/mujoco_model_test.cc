#include "mjdiag/plugin/plant/mujoco_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "mjdiag/plugin/plant/newer_mjcf.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kBonder = std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383/plant.xml";

using test::MessageOf;

std::string LoadError(const std::string& xml) {
  const test::TemporaryFolder folder;
  const std::string file = folder.Write("mujoco_model_test.xml", xml);
  return MessageOf<InputError>([&] { LoadModel(file); });
}

TEST(LoadModel, SaysFileAndLineOfMalformedXml) {
  EXPECT_THAT(LoadError("<mujoco>\n  <worldbody>\n  </wordbody>\n</mujoco>"),
              AllOf(HasSubstr("mujoco_model_test.xml:"), Not(HasSubstr("\n"))));
}

TEST(LoadModel, SaysFileAndLineOfAnUnknownAttribute) {
  EXPECT_THAT(LoadError("<mujoco>\n  <worldbody>\n    <body weight=\"3\"/>\n"
                        "  </worldbody>\n</mujoco>"),
              AllOf(HasSubstr("mujoco_model_test.xml:3: "), HasSubstr("weight"),
                    Not(HasSubstr("\n"))));
}

TEST(LoadModel, SaysFileAndLineOfAnUnknownJoint) {
  EXPECT_THAT(LoadError("<mujoco>\n  <actuator>\n    <motor joint=\"nobody\"/>\n"
                        "  </actuator>\n</mujoco>"),
              AllOf(HasSubstr("mujoco_model_test.xml:3: "), HasSubstr("nobody"),
                    Not(HasSubstr("\n"))));
}

TEST(LoadModel, NamesAFileThatIsNotThere) {
  EXPECT_THAT(MessageOf<InputError>([] { LoadModel("/nowhere/plant.xml"); }),
              HasSubstr("/nowhere/plant.xml"));
}

TEST(LoadModel, TurnsErrorsInsideMujocoIntoExceptions) {
  const ModelPtr model = LoadModel(kBonder);
  EXPECT_THAT(MessageOf<NumericalError>([] { mju_error("stack overflow"); }),
              HasSubstr("MuJoCo: stack overflow"));
}

TEST(LoadModel, ListsAllThatANewerMujocoWouldKnow) {
  const test::TemporaryFolder folder;
  folder.Write("parts.xml", "<mujoco><default><position kv=\"1\"/></default></mujoco>");
  const std::string file = folder.Write("newer.xml", R"(<mujoco>
  <option integrator="implicitfast"/>
  <include file="parts.xml"/>
  <worldbody>
    <frame pos="0 0 1">
      <body gravcomp="1">
        <joint name="j" range="-1 1" actuatorfrcrange="-1 1"/>
        <geom size="1" colour="red"/>
      </body>
    </frame>
    <body><joint range="-1 1" actuatorfrcrange="-2 2"/><geom size="1"/></body>
  </worldbody>
  <actuator><position joint="j" inheritrange="1"/></actuator>
</mujoco>)");
  const std::string error = MessageOf<InputError>([&] { LoadModel(file); });
  EXPECT_THAT(error, HasSubstr("written for MuJoCo 3.1.3 or newer; this one, 2.2.2"));
  for (const char* item :
       {"option integrator=\"implicitfast\" (line 2, 2.3.3): implicit;",
        "position kv (line 1 of parts.xml, 3.1.0): <general biastype",
        "<frame> (line 5, 3.1.0): ", "body gravcomp (line 6, 2.3.1): ",
        "joint actuatorfrcrange (line 7, 3.0.0): forcerange of its actuators;",
        "geom colour (line 8, misspelt, or newer still)",
        "position inheritrange (line 13, 3.1.3): ctrlrange",
        "range without limited (line 7, 3.0.0): <compiler autolimits=\"true\"/>"}) {
    EXPECT_THAT(error, HasSubstr(item));
  }
  EXPECT_THAT(error, Not(HasSubstr("\n")));
  EXPECT_THAT(error, Not(HasSubstr("line 11"))) << "each once";
}

TEST(LoadModel, ReadsAUrdfWhoseActuatorsAreMissing) {
  const test::TemporaryFolder folder;
  const ModelPtr model = LoadModel(folder.Write("arm.urdf", R"(<robot name="arm">
  <link name="base"/>
  <link name="l1"><inertial><mass value="1"/><origin xyz="0 0 0.1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j1" type="revolute"><parent link="base"/><child link="l1"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="1"/></joint>
</robot>)"));
  EXPECT_EQ(model->njnt, 1);
  EXPECT_EQ(
      MessageOf<InputError>([&] { FindElement(*model, mjOBJ_SENSOR, "q"); }),
      "arm: no sensor named \"q\", and no sensor at all; expected an MJCF with "
      "<actuator> and <sensor>, of which a URDF has none: `mjdiag init` writes one");
}

// Whatever a model of this MuJoCo has, the table does not call newer.
TEST(NewerThanThisMujoco, HasNothingOfPlantsThatLoad) {
  for (const char* plant : {"ab383", "emps", "panda", "servo", "voice_coil"}) {
    const auto newer = NewerThanThisMujoco(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/" +
                                           plant + "/plant.xml");
    EXPECT_TRUE(newer.empty()) << plant << ": " << newer.front().words;
  }
}

TEST(FindElement, FindsWhatIsThere) {
  const ModelPtr model = LoadModel(kBonder);
  const int joint = FindElement(*model, mjOBJ_JOINT, "u4");
  EXPECT_EQ(ElementName(*model, mjOBJ_JOINT, joint), "u4");
}

TEST(LoadModel, SaysWhatIsNoFile) {
  const test::TemporaryFolder folder;
  const std::string missing = (folder.path() / "missing.xml").string();
  EXPECT_EQ(MessageOf<InputError>([&] { LoadModel(missing); }),
            missing +
                ": cannot be opened (No such file or directory); expected an "
                "MJCF or URDF file");
  EXPECT_THAT(MessageOf<InputError>([&] { LoadModel(folder.path()); }),
              HasSubstr("is a folder; expected an MJCF or URDF file"));
}

// "sensor 1" is what it is called in messages, and no name that a setup can give.
TEST(FindElement, AsksForTheNamesThatAreMissing) {
  const test::TemporaryFolder folder;
  const std::string body = R"(<worldbody><body><joint name="j"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>)";
  const ModelPtr all =
      LoadModel(folder.Write("all.xml", "<mujoco>" + body +
                                            "<sensor><jointpos joint=\"j\"/></sensor>"
                                            "</mujoco>"));
  EXPECT_THAT(MessageOf<InputError>([&] { FindElement(*all, mjOBJ_SENSOR, "q"); }),
              HasSubstr("expected a name in the MJCF for sensor 0: `mjdiag init` "
                        "writes a copy with names"));
  const ModelPtr some = LoadModel(
      folder.Write("some.xml", "<mujoco>" + body +
                                   "<sensor><jointpos name=\"p\" joint=\"j\"/>"
                                   "<jointvel joint=\"j\"/></sensor></mujoco>"));
  EXPECT_THAT(MessageOf<InputError>([&] { FindElement(*some, mjOBJ_SENSOR, "q"); }),
              HasSubstr("expected one of p, or a name in the MJCF for sensor 1: "));
}

TEST(FindElement, ListsWhatIsThere) {
  const ModelPtr model = LoadModel(kBonder);
  EXPECT_EQ(MessageOf<InputError>([&] { FindElement(*model, mjOBJ_SENSOR, "w"); }),
            "ab383: no sensor named \"w\"; expected one of x_encoder, y_encoder, "
            "z_encoder");
}

TEST(ElementName, OfANamelessElementIsItsKindAndNumber) {
  EXPECT_EQ(ElementName(*LoadModel(kBonder), mjOBJ_LIGHT, 0), "key");
  const test::TemporaryFolder folder;
  const std::string file =
      folder.Write("nameless.xml", "<mujoco><worldbody><light/></worldbody></mujoco>");
  EXPECT_EQ(ElementName(*LoadModel(file), mjOBJ_LIGHT, 0), "light 0");
}

TEST(CopyModel, IsADeepCopy) {
  const ModelPtr model = LoadModel(kBonder);
  const ModelPtr copy = CopyModel(*model);
  copy->body_mass[1] = 1.0;
  EXPECT_NE(model->body_mass[1], 1.0);
}

std::vector<std::byte> BytesOf(const mjModel& model) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(mj_sizeModel(&model)));
  mj_saveModel(&model, nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

TEST(CopyModel, IntoTheMemoryOfADroppedOneLeavesNothingOfThat) {
  const ModelPtr model = LoadModel(kBonder);
  ModelPtr dropped = CopyModel(*model);
  const mjModel* memory = dropped.get();
  dropped->body_mass[1] = 1.0;
  dropped->opt.timestep = 1.0;
  dropped->geom_rgba[0] = 0.5f;
  DropScenery(*dropped);
  dropped.reset();
  const ModelPtr copy = CopyModel(*model);
  EXPECT_EQ(copy.get(), memory);
  EXPECT_EQ(BytesOf(*copy), BytesOf(*model));
}

TEST(CopyModel, OfOtherSizesTakesOtherMemory) {
  const ModelPtr model = LoadModel(kBonder);
  ModelPtr dropped = CopyModel(*model);
  const mjModel* memory = dropped.get();
  dropped.reset();
  const test::TemporaryFolder folder;
  const ModelPtr other = LoadModel(
      folder.Write("other.xml", "<mujoco><worldbody><light/></worldbody></mujoco>"));
  const ModelPtr copy = CopyModel(*other);
  EXPECT_NE(copy.get(), memory);
  EXPECT_EQ(BytesOf(*copy), BytesOf(*other));
}

}  // namespace
}  // namespace mjdiag
