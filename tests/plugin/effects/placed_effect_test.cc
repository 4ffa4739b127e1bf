#include "mjdiag/plugin/effects/placed_effect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

ModelPtr Emps() {
  return LoadModel(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/emps/plant.xml");
}

TEST(Effect, IsParsedFromTheCommandLineForm) {
  const PlacedEffect placed = ParseEffect("force_ripple@Y:period=0.024,amplitude=0.5");
  EXPECT_EQ(placed.name(), "force_ripple");
  EXPECT_EQ(placed.site, "Y");
  // In their own order, the phase as its fallback has it.
  EXPECT_EQ(placed.values, Eigen::Vector3d(0.5, 0.024, 0.0));
  EXPECT_EQ(placed.Value("period"), 0.024);
}

TEST(Effect, SaysWhatIsMalformed) {
  EXPECT_THAT(test::MessageOf<InputError>([] { ParseEffect("coulomb_friction"); }),
              HasSubstr("no site"));
  EXPECT_THAT(
      test::MessageOf<InputError>([] { ParseEffect("coulomb_friction@X:force"); }),
      HasSubstr("'force' has no value"));
  EXPECT_THAT(
      test::MessageOf<InputError>([] { ParseEffect("coulomb_friction@X:force=big"); }),
      HasSubstr("'big' is not a number"));
  EXPECT_THAT(test::MessageOf<InputError>([] { ParseEffect("a@X:force=1,force=2"); }),
              HasSubstr("given twice"));
}

TEST(Effect, NamesTheKnownOnesWhenItIsNotOne) {
  const ModelPtr model = Emps();
  const auto message = [&](const char* text) {
    return test::MessageOf<InputError>([&] { CheckEffect(*model, ParseEffect(text)); });
  };
  EXPECT_THAT(message("stiction@load:force=1"), HasSubstr("coulomb_friction"));
  EXPECT_THAT(message("coulomb_friction@lode:force=1"), HasSubstr("load"));
  EXPECT_THAT(message("coulomb_friction@load:mu=1"),
              HasSubstr("unknown parameter 'mu'"));
  EXPECT_THAT(message("coulomb_friction@load"), HasSubstr("'force' is missing"));
  EXPECT_THAT(message("coulomb_friction@load:force=-1"), HasSubstr("a value from 0"));
}

// A block on dry friction decelerates at force / mass until it stands, and then stands.
TEST(Effect, CoulombFrictionStopsTheLoadAsTheoryHasIt) {
  const ModelPtr model = Emps();
  model->dof_damping[0] = 0.0;
  ApplyEffect(*model, ParseEffect("coulomb_friction@load:force=20"));
  const DataPtr data = MakeData(*model);
  const double speed = 0.05;
  const double deceleration = 20.0 / 95.1;
  data->qvel[0] = speed;
  while (data->time < 0.5) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qpos[0], speed * speed / (2.0 * deceleration), 1e-5);
  const double stopped = data->qpos[0];
  while (data->time < 1.5) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qpos[0], stopped, 1e-9);
}

// Below the friction force nothing moves; creep of the soft default solver parameters
// would show here.
TEST(Effect, CoulombFrictionHoldsAgainstASmallerForce) {
  const ModelPtr model = Emps();
  ApplyEffect(*model, ParseEffect("coulomb_friction@load:force=20"));
  const DataPtr data = MakeData(*model);
  data->qfrc_applied[0] = 19.0;
  while (data->time < 1.0) mj_step(model.get(), data.get());
  EXPECT_LT(std::abs(data->qpos[0]), 1e-6);
}

TEST(Effect, ForceOffsetAddsItsForceEachStepOnce) {
  const ModelPtr model = Emps();
  const DataPtr data = MakeData(*model);
  ActiveEffects effects({}, *model,
                        {ParseEffect("force_offset@load:force=-3"),
                         ParseEffect("force_offset@load:force=1")});
  effects.Act(*model, *data);
  effects.Act(*model, *data);
  EXPECT_DOUBLE_EQ(data->qfrc_applied[0], -2.0);
}

TEST(Effect, IsReadFromThePlantItself) {
  char error[256] = "";
  const char* xml = R"(<mujoco>
    <custom><numeric name="effect.force_offset.slide" data="3.5"/></custom>
    <worldbody><body><joint name="slide" type="slide"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>)";
  mjVFS vfs;
  mj_defaultVFS(&vfs);
  mj_makeEmptyFileVFS(&vfs, "m.xml", static_cast<int>(std::strlen(xml)));
  std::memcpy(vfs.filedata[0], xml, std::strlen(xml));
  const ModelPtr model(mj_loadXML("m.xml", &vfs, error, sizeof(error)));
  mj_deleteVFS(&vfs);
  ASSERT_NE(model, nullptr) << error;
  const std::vector<PlacedEffect> effects = EffectsOf(*model);
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].site, "slide");
  EXPECT_DOUBLE_EQ(effects[0].Value("force"), 3.5);
}

}  // namespace
}  // namespace mjdiag
