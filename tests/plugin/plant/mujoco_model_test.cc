#include "mjdiag/plugin/plant/mujoco_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

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

TEST(FindElement, FindsWhatIsThere) {
  const ModelPtr model = LoadModel(kBonder);
  const int joint = FindElement(*model, mjOBJ_JOINT, "u4");
  EXPECT_EQ(ElementName(*model, mjOBJ_JOINT, joint), "u4");
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
