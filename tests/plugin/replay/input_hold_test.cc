#include "mjdiag/plugin/replay/input_hold.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kTick = 0.01;  // s
constexpr double kMass = 2.0;   // kg
constexpr double kDrag = 3.0;   // N s/m

/// A carriage that the plant has without its drag.
class InputHold : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("plant.xml",
                  R"(<mujoco><option timestep="0.001"/><worldbody><body>
      <joint name="j" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/></body></worldbody>
      <actuator><motor name="u" joint="j"/></actuator>
      <sensor><jointpos name="y" joint="j"/></sensor></mujoco>)");
  }

  mjdiag::Setup SetupWith(const std::string& more) {
    folder_.Write("setup.toml",
                  "schema = \"mjdiag.setup/1\"\nname = \"carriage\"\n"
                  "plant = \"plant.xml\"\n[rates]\ncontrol = 100.0\nsubsteps = 10\n"
                  "[sensors.y]\nelement = \"y\"\nunit = \"m\"\n"
                  "[actuators.u]\nelement = \"u\"\nunit = \"N\"\n" +
                      more);
    return ReadSetup(folder_.path());
  }

  static double Force(double t) {
    return 5.0 * std::sin(3.1 * t) + 4.0 * std::sin(17.0 * t + 1.0);
  }

  /// Integrated in steps of 20 us; its force is a function of time, or keeps what it was at the
  /// tick.
  std::string Record(bool is_held) {
    std::string text = "time [s],y [m],u [N]\n";
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 1e-6);
    constexpr int kSteps = 500;
    double x = 0.0;
    double v = 0.0;
    for (int k = 0; k < 1500; ++k) {
      const double t = k * kTick;
      char row[96];
      std::snprintf(row, sizeof row, "%.6f,%.9f,%.9f\n", t, x + noise(random),
                    Force(t));
      text += row;
      for (int i = 0; i < kSteps; ++i) {
        const double dt = kTick / kSteps;
        const double force = Force(is_held ? t : t + (i + 0.5) * dt);
        v += dt * (force - kDrag * v) / kMass;
        x += dt * v;
      }
    }
    WriteTextFile(folder_ / "record.csv", text);
    return (folder_ / "record.csv").string();
  }

  test::TemporaryFolder folder_;
};

TEST_F(InputHold, IsToldByTheRecordWhateverThePlantLacks) {
  const mjdiag::Setup setup = SetupWith("");
  EXPECT_GT(GainOfStraightInputs(setup, Record(false)), 10.0);
  EXPECT_LT(GainOfStraightInputs(setup, Record(true)), -10.0);
}

TEST_F(InputHold, IsUnknownOfInputsOfWhichTheSetupDoesNotSayIt) {
  EXPECT_THAT(InputsOfUnknownHold(SetupWith("")), ElementsAre("u"));
  EXPECT_THAT(InputsOfUnknownHold(SetupWith("hold = \"zero\"\n")), IsEmpty());
  // A controller of the setup holds what it puts out.
  EXPECT_THAT(InputsOfUnknownHold(ReadSetup("mjcf/ab383")), IsEmpty());
}

}  // namespace
}  // namespace mjdiag
