#include "mjdiag/plugin/plant/fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>
#include <sstream>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/count_allocations.h"
#include "support/message_of.h"
#include "support/numbered_plant.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using test::MessageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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

ModelPtr WithFault(const std::string& data) {
  return test::SmallPlant(test::NumberedMjcf(
      test::kNumberedValues,
      R"(<custom><text name="fault.worn" data=")" + data + R"("/></custom>)"));
}

/// Positions along a swing, under a model that another becomes on the way.
Eigen::VectorXd Swing(const mjModel& model) {
  constexpr int kSteps = 200;
  const DataPtr data = MakeData(model);
  Eigen::VectorXd all(kSteps * model.nv);
  for (int k = 0; k < kSteps; ++k) {
    for (int u = 0; u < model.nu; ++u) data->ctrl[u] = 0.4;
    mj_step(&model, data.get());
    all.segment(model.nv * k, model.nv) = Eigen::VectorXd::Map(data->qpos, model.nv);
  }
  return all;
}

const std::vector<std::string> kEveryFault = {"mass fore",
                                              "inertia fore",
                                              "stiffness shoulder slide",
                                              "damping shoulder elbow",
                                              "friction shoulder",
                                              "armature shoulder",
                                              "gear push volts",
                                              "gain volts",
                                              "kp servo drive",
                                              "kv drive",
                                              "tendon_stiffness cable",
                                              "tendon_damping cable",
                                              "tendon_friction rope"};

TEST(ApplyFault, IsTheNumbersOfItsKindTogether) {
  for (const std::string& data : kEveryFault) {
    const ModelPtr faulty = WithFault(data);
    const ModelPtr scaled = CopyModel(*faulty);
    NumberFactors factors;
    std::istringstream words(data);
    std::string kind;
    std::string element;
    words >> kind;
    while (words >> element) {
      factors.emplace_back(FindModelParameter(*scaled, kind + "@" + element), 0.7);
    }
    const Eigen::VectorXd healthy = Swing(*faulty);
    ScaleNumbers(*scaled, factors);
    ApplyFault(*faulty, {"worn", 0.7});
    EXPECT_EQ(Swing(*faulty), Swing(*scaled)) << data;
    EXPECT_NE(Swing(*faulty), healthy) << data;
  }
}

TEST(CopyFaults, GivesARunningModelAllThatFaultsChange) {
  for (const std::string& data : kEveryFault) {
    const ModelPtr running = WithFault(data);
    const ModelPtr faulty = CopyModel(*running);
    ApplyFault(*faulty, {"worn", 1.4});
    const long allocations =
        test::CountAllocations([&] { CopyFaults(*faulty, *running); });
    EXPECT_EQ(allocations, 0);
    EXPECT_EQ(Swing(*running), Swing(*faulty)) << data;
  }
}

// In straight lines: masses, and what their constants are in the middle and at the end.
TEST(ApproachFaults, GoesThereByEqualPartsAndArrives) {
  const ModelPtr target = WithFault("mass fore");
  const ModelPtr running = CopyModel(*target);
  ApplyFault(*target, {"worn", 2.0});
  const int fore = FindElement(*target, mjOBJ_BODY, "fore");
  for (int left = 4; left > 0; --left) {
    ApproachFaults(*target, 1.0 / left, *running);
    EXPECT_NEAR(running->body_mass[fore], 1.5 * (1.0 + (5 - left) / 4.0), 1e-12);
    EXPECT_LE(running->dof_invweight0[1], WithFault("mass fore")->dof_invweight0[1]);
    EXPECT_GE(running->dof_invweight0[1], target->dof_invweight0[1]);
  }
  EXPECT_NEAR(running->dof_invweight0[1], target->dof_invweight0[1], 1e-12);
}

TEST(FaultParameters, NameWhatIsWrongInTheirDeclaration) {
  EXPECT_THAT(
      MessageOf<InputError>([] { FaultParameters(*WithParameter("damping Q")); }),
      AllOf(HasSubstr("fault.zeta"), HasSubstr("no joint named \"Q\""),
            HasSubstr("one of x")));
  EXPECT_THAT(
      MessageOf<InputError>([] { FaultParameters(*WithParameter("solref x")); }),
      AllOf(HasSubstr("fault.zeta"), HasSubstr("solref"),
            HasSubstr("tendon_friction@ a tendon"), Not(HasSubstr("centre_x"))));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithParameter("ref x")); }),
              HasSubstr("unknown kind of fault parameter"));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithFault("gain push")); }),
              AllOf(HasSubstr("fault.worn"), HasSubstr("affine bias")));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithParameter("gear x")); }),
              HasSubstr("no actuator named \"x\""));
  EXPECT_THAT(MessageOf<InputError>([] { FaultParameters(*WithParameter("damping")); }),
              AllOf(HasSubstr("fault.zeta"), HasSubstr("no element")));
}

}  // namespace
}  // namespace mjdiag
