#include "mjdiag/plugin/plant/fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using test::MessageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

ModelPtr Bonder() { return CopyModel(test::Bonder().plant()); }

/// A model whose only fault parameter is `data`.
ModelPtr WithParameter(const std::string& data) {
  const test::TemporaryFolder folder;
  return LoadModel(folder.Write(
      "fault_test.xml", R"(<mujoco><custom><text name="fault.zeta" data=")" + data +
                            R"("/></custom><worldbody><body>
      <joint name="x" type="slide"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>)"));
}

TEST(FaultParameters, OfTheBonderAreTheOnesItDeclares) {
  std::vector<std::string> names;
  for (const FaultParameter& parameter : FaultParameters(*Bonder()))
    names.push_back(parameter.name);
  EXPECT_THAT(names, ElementsAre("zeta_x", "zeta_y", "beta_x", "beta_y", "eta_x",
                                 "eta_y", "eta_z"));
}

/// Names of all that a fault parameter may scale and that differs.
std::vector<std::string> Changes(const mjModel& healthy, const mjModel& faulty) {
  std::vector<std::string> changes;
  for (int j = 0; j < healthy.njnt; ++j) {
    const std::string name = ElementName(healthy, mjOBJ_JOINT, j);
    if (faulty.dof_damping[j] != healthy.dof_damping[j]) {
      changes.push_back("damping " + name);
    }
    if (faulty.jnt_stiffness[j] != healthy.jnt_stiffness[j]) {
      changes.push_back("stiffness " + name);
    }
    if (faulty.qpos_spring[j] != healthy.qpos_spring[j]) {
      changes.push_back("preload " + name);
    }
  }
  for (int i = 0; i < 6 * healthy.nu; ++i) {
    if (faulty.actuator_gear[i] != healthy.actuator_gear[i]) {
      changes.push_back("gear " + ElementName(healthy, mjOBJ_ACTUATOR, i / 6));
    }
  }
  return changes;
}

TEST(ApplyFault, ScalesWhatTheParameterNamesAndNothingElse) {
  const ModelPtr healthy = Bonder();
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected = {
      {"zeta_x", {"damping X"}},
      {"zeta_y", {"damping Y"}},
      {"beta_x", {"stiffness u3", "stiffness r2"}},
      {"beta_y", {"stiffness u4", "stiffness r3"}},
      {"eta_x", {"gear x_motor"}},
      {"eta_y", {"gear y_motor"}},
      {"eta_z", {"gear z_motor"}}};
  for (const auto& [parameter, changes] : expected) {
    const ModelPtr faulty = CopyModel(*healthy);
    ApplyFault(*faulty, {parameter, 0.97});
    EXPECT_EQ(Changes(*healthy, *faulty), changes) << parameter;
  }
}

TEST(ApplyFault, MultipliesByTheValue) {
  const ModelPtr healthy = Bonder();
  const ModelPtr faulty = CopyModel(*healthy);
  ApplyFault(*faulty, {"zeta_x", 1.2});
  ApplyFault(*faulty, {"eta_y", 0.5});
  const int x = FindElement(*healthy, mjOBJ_JOINT, "X");
  const int y_motor = FindElement(*healthy, mjOBJ_ACTUATOR, "y_motor");
  EXPECT_DOUBLE_EQ(faulty->dof_damping[x], 1.2 * healthy->dof_damping[x]);
  EXPECT_DOUBLE_EQ(faulty->actuator_gear[6 * y_motor + 1], 0.5);
}

TEST(ApplyFault, ListsTheParametersThatThereAre) {
  const ModelPtr bonder = Bonder();
  EXPECT_THAT(MessageOf<InputError>([&] {
                ApplyFault(*bonder, {"zeta_q", 1.0});
              }),
              AllOf(HasSubstr("zeta_q"), HasSubstr("zeta_x, zeta_y, beta_x, beta_y")));
}

TEST(ApplyFault, RefusesValuesThatAreNoFactors) {
  const ModelPtr bonder = Bonder();
  for (const double value : {-0.1, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(MessageOf<InputError>([&] {
                  ApplyFault(*bonder, {"zeta_x", value});
                }),
                HasSubstr("out of range"));
  }
}

TEST(FaultParameters, NameWhatIsWrongInTheirDeclaration) {
  EXPECT_THAT(
      MessageOf<InputError>([] { FaultParameters(*WithParameter("damping Q")); }),
      AllOf(HasSubstr("fault.zeta"), HasSubstr("no joint named \"Q\""),
            HasSubstr("one of x")));
  EXPECT_THAT(
      MessageOf<InputError>([] { FaultParameters(*WithParameter("friction x")); }),
      AllOf(HasSubstr("fault.zeta"), HasSubstr("friction")));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithParameter("gear x")); }),
              HasSubstr("no actuator named \"x\""));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithParameter("damping")); }),
              AllOf(HasSubstr("fault.zeta"), HasSubstr("no element")));
}

}  // namespace
}  // namespace mjdiag
