// mjdiag linearize of plants that are no trees of slides and hinges at rest.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/command_line.h"

namespace mjdiag {
namespace {

using nlohmann::json;

/// A machine of its own in a folder.
class LinearizeCommand : public ::testing::Test {
 protected:
  static constexpr const char* kChannels = R"(schema = "mjdiag.setup/1"
name = "Own"
plant = "plant.xml"
[rates]
control = 500.0
substeps = 2
[actuators.tau]
element = "motor"
unit = "N m"
[sensors.q]
element = "encoder"
unit = "rad"
)";
  /// A link of 1 kg, its centre 0.2 m from the hinge, drawn horizontal.
  static constexpr const char* kLink = R"(<mujoco model="link">
    <compiler angle="radian"/><option timestep="0.001" tolerance="1e-12"/>
    <worldbody><body name="link"><joint name="hinge" axis="0 1 0" damping="0.1"/>
      <inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body></worldbody>
    <actuator><motor name="motor" joint="hinge"/></actuator>
    <sensor><jointpos name="encoder" joint="hinge"/></sensor>
    <keyframe><key name="raised" qpos="-1"/></keyframe>
  </mujoco>)";

  void Write(const std::string& plant, const std::string& setup = kChannels) {
    folder_.Write("plant.xml", plant);
    folder_.Write("setup.toml", setup);
  }
  CommandResult Run(const std::string& more) {
    return RunCommand("linearize --setup '" + folder_.path().string() + "' " + more);
  }
  json Document(const std::string& more = "") {
    const CommandResult result = Run(more + " --json");
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out);
  }

  TemporaryFolder folder_;
};

TEST_F(LinearizeCommand, FindsTheHangingRestOfALinkThatIsDrawnHorizontal) {
  Write(kLink);
  const json document = Document();
  EXPECT_NEAR(document["about"]["pose"]["hinge"], M_PI / 2.0, 1e-9);
  EXPECT_EQ(document["about"]["rests"], true);
  EXPECT_EQ(document["about"]["stable"], true);
  EXPECT_NEAR(document["K"][0][0], 9.81 * 0.2, 1e-9);
  EXPECT_EQ(document["tick"]["A"].size(), 2u);
  EXPECT_NEAR(document["tick"]["sample_time"], 0.002, 1e-12);
  EXPECT_NEAR(document["step"]["sample_time"], 0.001, 1e-12);
}

TEST_F(LinearizeCommand, SaysWhatHoldsItAndThatItFallsAtAKeyframe) {
  Write(kLink);
  const json about = Document("--at keyframe:raised")["about"];
  EXPECT_EQ(about["rests"], false);
  EXPECT_EQ(about["stable"], false);
  EXPECT_NEAR(about["holding_force"]["hinge"], -9.81 * 0.2 * std::cos(1.0), 1e-9);
  EXPECT_NEAR(about["inputs"]["tau"], -9.81 * 0.2 * std::cos(1.0), 1e-9);
  const std::string text = Run("--at keyframe:raised").out;
  EXPECT_NE(text.find("held by its actuators with -1.06 N m at hinge"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("not stable"), std::string::npos) << text;
}

TEST_F(LinearizeCommand, FindsTheMotionOfAMomentOfARecord) {
  Write(kLink);
  std::string record = "time [s],tau [N m],q [rad]\n";
  for (int k = 0; k <= 500; ++k) {
    const double t = 0.002 * k;
    record +=
        std::to_string(t) + ",0.5," + std::to_string(0.3 + 2.0 * t - t * t) + "\n";
  }
  const std::string file = folder_.Write("run.csv", record);
  const json document = Document("--at '" + file + "@0.4'");
  EXPECT_NEAR(document["about"]["pose"]["hinge"], 0.3 + 0.8 - 0.16, 1e-5);
  EXPECT_NEAR(document["about"]["velocity"]["hinge"], 1.2, 1e-3);
  EXPECT_NEAR(document["K"][0][0], 9.81 * 0.2 * std::sin(0.94), 1e-4);
  EXPECT_NEAR(document["about"]["inputs"]["tau"], 0.5, 1e-9);
  // I q'' + d q' - m g l cos q = tau + what is missing.
  EXPECT_NEAR(document["about"]["applied_force"]["hinge"],
              0.05 * -2.0 + 0.1 * 1.2 - 9.81 * 0.2 * std::cos(0.94) - 0.5, 2e-3);
}

TEST_F(LinearizeCommand, NamesWhatIsNoPlace) {
  Write(kLink);
  for (const auto& [at, words] :
       {std::pair{"somewhere", "rest, start, keyframe:NAME or RECORD@TIME"},
        std::pair{"keyframe:home", "one of raised"},
        std::pair{"run.csv@noon", "TIME in seconds"}}) {
    const CommandResult result = Run(std::string("--at ") + at);
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  }
}

// A rotor without a bearing that rubs: two poles at 0, and no oscillation.
TEST_F(LinearizeCommand, SaysThatThereAreNoModes) {
  std::string rotor = kLink;
  rotor.replace(rotor.find("0 1 0\" damping=\"0.1\""), 20, "1 0 0\"");
  Write(rotor);
  EXPECT_NE(Run("").out.find("no modes: nothing pulls it back or damps it"),
            std::string::npos);
  EXPECT_TRUE(Document()["modes"].empty());
}

TEST_F(LinearizeCommand, SaysOfWhatSwingsUndampedThatItIsUndamped) {
  std::string link = kLink;
  link.replace(link.find(" damping=\"0.1\""), 14, "");
  Write(link);
  const json mode = Document()["modes"].at(0);
  EXPECT_FALSE(std::signbit(mode["damping_ratio"].get<double>()));
}

TEST_F(LinearizeCommand, NamesIndependentCoordinatesOfTiedSlides) {
  Write(R"(<mujoco model="gantry"><option timestep="0.001" tolerance="1e-12"/>
    <worldbody>
      <body><joint name="y1" type="slide" axis="1 0 0" damping="60"/>
        <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/></body>
      <body pos="0 1 0"><joint name="y2" type="slide" axis="1 0 0" damping="60"/>
        <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/></body>
    </worldbody>
    <equality><joint joint1="y1" joint2="y2"/></equality>
    <actuator><motor name="motor" joint="y1"/></actuator>
    <sensor><jointpos name="encoder" joint="y2"/></sensor></mujoco>)");
  const json document = Document();
  EXPECT_EQ(document["independent"], json({"y1"}));
  EXPECT_NEAR(document["dependent"]["y2"]["y1"], 1.0, 1e-9);
  EXPECT_NEAR(document["M"][0][0], 8.0, 1e-9);
  EXPECT_EQ(document["modes"].size(), 1u);
}

TEST_F(LinearizeCommand, HoldsAFreeBodyThatFalls) {
  Write(R"(<mujoco model="falls"><option timestep="0.001"/>
    <worldbody><body><freejoint name="base"/>
      <inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/><site name="s"/></body>
    </worldbody>
    <actuator><motor name="motor" site="s" gear="1 0 0 0 0 0"/></actuator>
    <sensor><gyro name="encoder" site="s"/></sensor></mujoco>)");
  const json document = Document();
  EXPECT_EQ(document["coordinates"][2], "base.z");
  EXPECT_NEAR(document["about"]["holding_force"]["base.z"], 2.0 * 9.81, 1e-9);
  EXPECT_EQ(document["about"]["pose"]["base"].size(), 7u);
  EXPECT_EQ(document["states"].size(), 12u);
  EXPECT_EQ(document["notes"].size(), 1u);
  EXPECT_NE(Run("").out.find("nothing rests: about the pose drawn, held by 19.6 N at "
                             "base.z"),
            std::string::npos);
}

}  // namespace
}  // namespace mjdiag
