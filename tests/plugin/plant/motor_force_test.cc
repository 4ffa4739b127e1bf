#include "mjdiag/plugin/plant/motor_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "plugin/effects/effect_bench.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

ModelPtr Driven(const std::string& actuator) {
  return test::ModelOf(
      R"(<mujoco><worldbody><body><joint name="q" type="hinge" axis="0 1 0"/>
      <geom size="0.1" pos="0 0 -0.1"/></body></worldbody><actuator>)" +
      actuator + "</actuator></mujoco>");
}

constexpr const char* kLimited = R"( ctrllimited="true" ctrlrange="-1 1"/>)";

/// kt 0.4, R 2 and a spring of the drive; to be closed.
const std::string kMotor =
    R"(<general name="m" joint="q" gear="0.4" gainprm="0.5" biastype="affine"
       biasprm="0.01 -0.3 -0.5")";

/// Moving, and driven by 3 V.
DataPtr Moving(const mjModel& model) {
  DataPtr data = MakeData(model);
  data->qpos[0] = 0.2;
  data->qvel[0] = 5.0;
  data->ctrl[0] = 3.0;
  mj_forward(&model, data.get());
  return data;
}

TEST(MotorForce, IsWhatMuJoCoComputes) {
  for (const char* range :
       {"/>", R"( forcelimited="true" forcerange="-0.1 0.2"/>)", kLimited}) {
    const ModelPtr model = Driven(kMotor + range);
    const DataPtr data = Moving(*model);
    EXPECT_NEAR(MotorForce(*model, *data, 0), data->actuator_force[0], 1e-15) << range;
    EXPECT_NE(data->actuator_force[0], 0.0);
  }
}

TEST(OpenCircuit, GivesNoForceWhateverTheMotion) {
  const ModelPtr model = Driven(kMotor + "/>");
  const DataPtr data = Moving(*model);
  data->ctrl[0] = OpenCircuitCommand(*model, *data, 0);
  mj_forward(model.get(), data.get());
  EXPECT_NEAR(data->actuator_force[0], 0.0, 1e-15);
  // Without the spring of the drive it is the back EMF, 0.4 * 5.
  const ModelPtr plain = Driven(
      R"(<general name="m" joint="q" gear="0.4" gainprm="0.5" biastype="affine"
         biasprm="0 0 -0.5"/>)");
  EXPECT_NEAR(OpenCircuitCommand(*plain, *Moving(*plain), 0), 2.0, 1e-12);
}

TEST(OpenCircuit, NeedsACommandThatCanMakeTheForceZero) {
  EXPECT_NO_THROW(CheckOpenCircuit(*Driven(kMotor + "/>"), 0));
  EXPECT_NO_THROW(CheckOpenCircuit(
      *Driven(R"(<motor name="m" joint="q")" + (" " + std::string(kLimited))), 0));
  for (const std::string& actuator :
       {kMotor + kLimited,
        std::string(R"(<general name="m" joint="q" gainprm="0"/>)")}) {
    EXPECT_THAT(
        test::MessageOf<InputError>([&] { CheckOpenCircuit(*Driven(actuator), 0); }),
        HasSubstr("actuator m"));
  }
}

TEST(MotorBias, IsTheSpringAndTheDamperOfMotorsThatAreOn) {
  const ModelPtr model = Driven(kMotor + "/>");
  const DataPtr data = Moving(*model);
  const MotorBias on = MotorBiasOf(*model, *data, {});
  EXPECT_NEAR(on.stiffness(0, 0), 0.3 * 0.4 * 0.4, 1e-15);
  EXPECT_NEAR(on.damping(0, 0), 0.5 * 0.4 * 0.4, 1e-15);
  const std::vector<int> off{0};
  EXPECT_EQ(MotorBiasOf(*model, *data, off).damping(0, 0), 0.0);
}

}  // namespace
}  // namespace mjdiag
