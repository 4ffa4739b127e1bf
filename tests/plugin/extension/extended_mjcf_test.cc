// MJCF as other people write it: classes, includes, meshes, degrees, bodies without
// inertial elements.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/extension/extended_plant.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/kept_folder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// A plant in one folder, extended into another.
class ExtendedMjcf : public ::testing::Test {
 protected:
  std::string Extend(const std::string& mjcf, const std::vector<std::string>& effects,
                     const std::vector<Fault>& faults = {}) {
    const std::string file = nominal_.Write("stage.xml", mjcf);
    expected_ = LoadModel(file);
    const ModelPtr plant = LoadModel(file);
    std::vector<PlacedEffect> specs;
    for (const Fault& fault : faults) ApplyFault(*expected_, fault);
    for (const std::string& effect : effects) {
      specs.push_back(ParseEffect(effect));
      ApplyEffect(*expected_, specs.back());
    }
    std::string text = ExtendMjcf(file, *plant, {faults, specs}, extended_.path());
    model_ = LoadModel(extended_.Write("plant.xml", text));
    for (const auto* folder : {&nominal_, &extended_}) test::KeepFolder(folder->path());
    return text;
  }

  /// What Extend throws.
  std::string Refusal(const std::string& mjcf, const std::string& effect) {
    return test::MessageOf<InputError>([&] { Extend(mjcf, {effect}); });
  }

  const test::TemporaryFolder nominal_;
  const test::TemporaryFolder extended_;
  ModelPtr expected_;  // with the causes applied in memory
  ModelPtr model_;     // from the extended text
};

TEST_F(ExtendedMjcf, TakesValuesFromClassesAndWritesThemAtTheElement) {
  const std::string text =
      Extend(R"(<mujoco>
  <default>
    <joint damping="3"/>
    <default class="drive"><motor gear="7"/></default>
  </default>
  <worldbody>
    <body><joint name="a" type="slide"/><geom size="0.1"/>
      <body><joint name="b" type="slide" axis="1 0 0"/><geom size="0.1"/></body>
    </body>
  </worldbody>
  <actuator><motor name="m" class="drive" joint="a"/></actuator>
</mujoco>
)",
             {"viscous_friction@a:coefficient=0.5", "motor_constant@m:factor=0.5"});
  EXPECT_THAT(text, HasSubstr(R"(<joint name="a" type="slide" damping="3.5"/>)"));
  EXPECT_EQ(model_->dof_damping[0], 3.5);
  EXPECT_EQ(model_->dof_damping[1], 3.0);
  EXPECT_EQ(model_->actuator_gear[0], 3.5);
}

TEST_F(ExtendedMjcf, GivesABodyOfGeomsTheInertialThatItHas) {
  const std::string text = Extend(R"(<mujoco>
  <worldbody>
    <body pos="1 2 3" quat="1 0.3 0 0">
      <joint name="a" type="slide"/>
      <geom size="0.1 0.2 0.3" type="box" euler="10 20 30" pos="0.1 0 0"/>
      <geom size="0.1" pos="0 0.4 0"/>
    </body>
  </worldbody>
</mujoco>
)",
                                  {"added_mass@a:mass=0.25"});
  EXPECT_THAT(text, HasSubstr("<body pos=\"1 2 3\" quat=\"1 0.3 0 0\">\n"
                              "      <inertial pos="));
  EXPECT_EQ(model_->body_mass[1], expected_->body_mass[1]);
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(model_->body_inertia[3 + i], expected_->body_inertia[3 + i]);
    EXPECT_DOUBLE_EQ(model_->body_ipos[3 + i], expected_->body_ipos[3 + i]);
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(model_->body_iquat[4 + i], expected_->body_iquat[4 + i], 1e-15);
  }
}

TEST_F(ExtendedMjcf, WritesTheSpringOfAHingeInDegrees) {
  Extend(R"(<mujoco>
  <worldbody>
    <body><geom size="0.1"/>
      <joint name="a" type="hinge" ref="5" springref="20" stiffness="3"/></body>
  </worldbody>
</mujoco>
)",
         {"linear_stiffness@a:stiffness=2"});
  EXPECT_EQ(model_->jnt_stiffness[0], 5.0);
  EXPECT_NEAR(model_->qpos_spring[0], expected_->qpos_spring[0], 1e-15);
  EXPECT_NEAR(model_->qpos_spring[0], (20 * 3 + 5 * 2) / 5.0 * M_PI / 180.0, 1e-15);
}

// springdamper derives stiffness and damping when the model is compiled.
TEST_F(ExtendedMjcf, OverridesASpringGivenByTimeConstantAndDamping) {
  Extend(R"(<mujoco>
  <default><joint springdamper="0.1 0.7"/></default>
  <worldbody>
    <body><joint name="a" type="slide"/><geom size="0.1"/></body>
  </worldbody>
</mujoco>
)",
         {"structural_stiffness@a:factor=0.5"});
  EXPECT_GT(model_->jnt_stiffness[0], 0.0);
  EXPECT_EQ(model_->jnt_stiffness[0], expected_->jnt_stiffness[0]);
  EXPECT_EQ(model_->dof_damping[0], expected_->dof_damping[0]);
}

TEST_F(ExtendedMjcf, WritesIncludedFilesInPlace) {
  std::filesystem::create_directory(nominal_ / "parts");
  nominal_.Write(
      "parts/stage.xml",
      "<mujocoinclude>\n  <!-- the stage -->\n"
      "  <body><include file=\"parts/joint.xml\"/><geom size='0.1'/></body>\n"
      "</mujocoinclude>\n");
  nominal_.Write("parts/joint.xml",
                 "<x><joint name='a' type='slide' damping='2'/></x>\n");
  const std::string text = Extend(
      "<mujoco>\n  <worldbody>\n    <include file=\"parts/stage.xml\"/>\n"
      "  </worldbody>\n</mujoco>\n",
      {"viscous_friction@a:coefficient=1", "quadratic_drag@a:coefficient=4"});
  EXPECT_EQ(
      text,
      "<mujoco>\n  <worldbody>\n    <!-- the stage -->\n"
      "  <body><joint name='a' type='slide' damping='3'/><geom size='0.1'/></body>\n"
      "  </worldbody>\n"
      "  <custom>\n"
      "    <numeric name=\"effect.quadratic_drag.a\" size=\"1\" data=\"4\"/>\n"
      "  </custom>\n</mujoco>\n");
}

TEST_F(ExtendedMjcf, FindsMeshesInTheOldFolder) {
  std::filesystem::create_directory(nominal_ / "mesh files");
  const std::string kTetrahedron =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  nominal_.Write("mesh files/t.obj", kTetrahedron);
  nominal_.Write("t.obj", kTetrahedron);
  const std::string body = R"(
  <asset><mesh name="t" file="t.obj"/></asset>
  <worldbody>
    <body><joint name="a" type="slide"/><geom type="mesh" mesh="t"/></body>
  </worldbody>
</mujoco>
)";
  for (const char* head : {"<mujoco>", "<mujoco><compiler angle=\"radian\"/>",
                           "<mujoco><compiler meshdir=\"mesh files\"/>"}) {
    Extend(head + body, {"force_offset@a:force=1"});
    EXPECT_EQ(model_->nmesh, 1) << head;
    EXPECT_EQ(model_->body_mass[1], expected_->body_mass[1]) << head;
  }
}

TEST_F(ExtendedMjcf, IsNotMisledByCommentsAndQuotes) {
  const std::string text =
      Extend(R"(<?xml version="1.0"?>
<mujoco>
  <!-- <joint name="a" damping="5"/> -->
  <custom><text name="note" data="a > b"/></custom>
  <worldbody>
    <body><joint
        type = 'slide'
        name = "a &amp; b" /><geom size="0.1"/></body>
  </worldbody>
</mujoco>
)",
             {"viscous_friction@a & b:coefficient=1", "force_offset@a & b:force=2"});
  EXPECT_THAT(text, HasSubstr(R"(<!-- <joint name="a" damping="5"/> -->)"));
  EXPECT_THAT(text, HasSubstr(R"(name = "a &amp; b" damping="1" />)"));
  EXPECT_THAT(text, HasSubstr(R"(data="a > b"/><numeric )"
                              R"(name="effect.force_offset.a &amp; b" size="1")"));
  EXPECT_EQ(model_->dof_damping[0], 1.0);
  EXPECT_EQ(EffectsOf(*model_).front().site, "a & b");
}

TEST_F(ExtendedMjcf, LimitsAMotorWhoseModelDoesNotLimitByItself) {
  Extend(R"(<mujoco>
  <worldbody><body><joint name="a" type="slide"/><geom size="0.1"/></body></worldbody>
  <actuator><motor name="m" joint="a"/></actuator>
</mujoco>
)",
         {"force_saturation@m:limit=2.5"});
  EXPECT_EQ(model_->actuator_forcelimited[0], 1);
  EXPECT_EQ(model_->actuator_forcerange[0], -2.5);
  EXPECT_EQ(model_->actuator_forcerange[1], 2.5);
}

TEST_F(ExtendedMjcf, RefusesAMassThatTheCompilerDerivesFromOthers) {
  const std::string body = R"(<worldbody>
  <body name="b"><joint name="a" type="slide"/><geom size="0.1"/></body></worldbody>
</mujoco>)";
  for (const char* option :
       {"settotalmass=\"3\"", "inertiafromgeom=\"true\"", "fusestatic=\"true\""}) {
    EXPECT_THAT(Refusal(std::string("<mujoco><compiler ") + option + "/>" + body,
                        "added_mass@a:mass=1"),
                HasSubstr("derives the mass of 'b' from other bodies"))
        << option;
  }
}

TEST_F(ExtendedMjcf, RefusesAJointThatIsNotWrittenOut) {
  const std::string rope = R"(<mujoco><worldbody>
  <body name="rB0"><composite type="rope" count="3 1 1" spacing="0.2" prefix="r">
    <geom size="0.05"/></composite></body></worldbody></mujoco>)";
  const ModelPtr model = LoadModel(nominal_.Write("rope.xml", rope));
  const std::string joint = ElementName(*model, mjOBJ_JOINT, model->njnt - 1);
  EXPECT_THAT(Refusal(rope, "viscous_friction@" + joint + ":coefficient=1"),
              HasSubstr("'" + joint + "' is not written out under its own name"));
}

}  // namespace
}  // namespace mjdiag
