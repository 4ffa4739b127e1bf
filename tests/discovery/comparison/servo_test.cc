// A robot servo, really measured. The data belongs to its authors and is not part of this
// repository: the folder is named by MJDIAG_SERVO_DATA, see docs/tour.md.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {
namespace {

std::filesystem::path DataFolder() {
  const char* named = std::getenv("MJDIAG_SERVO_DATA");
  return named != nullptr ? named : "";
}

class Servo : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(DataFolder() / "sin_sin_kp100.csv")) return;
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no servo data in " << DataFolder();
    GTEST_SKIP() << "no servo data: MJDIAG_SERVO_DATA names no folder with "
                    "sin_sin_kp100.csv";
  }
  /// Mean absolute error of the angle of the naive plant [rad].
  static double Error(const std::string& trajectory, int gain, bool open_loop) {
    mjdiag::Setup setup =
        ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo",
                  {"axes.q.feedback.numerator=[" + std::to_string(gain) + ".0]"});
    if (open_loop) setup = WithoutControllers(setup);
    const std::string file = trajectory + "_kp" + std::to_string(gain) + ".csv";
    const Record measured = ReadRecord(DataFolder() / file, setup.record);
    // Where the arm falls with its torque off it may leave the measurement.
    return CompareFree(Machine(setup), measured, {}).channels.at(0).mae;
  }
};

// The same pendulum and motor in 0.5 ms steps of semi-implicit Euler, in Python.
TEST_F(Servo, NaivePlantReachesTheIndependentSimulation) {
  EXPECT_NEAR(Error("sin_sin", 100, false), 76.47e-3, 0.2e-3);
  EXPECT_NEAR(Error("sin_time_square", 800, false), 76.61e-3, 0.2e-3);
  EXPECT_NEAR(Error("up_and_down", 200, false), 120.98e-3, 0.2e-3);
  EXPECT_NEAR(Error("sin_sin", 200, true), 218.60e-3, 0.5e-3);
}

// The arm falls with its torque off.
TEST_F(Servo, NaivePlantReachesItWhereTheTorqueIsOff) {
  EXPECT_NEAR(Error("lift_and_drop", 100, false), 195.82e-3, 0.5e-3);
  EXPECT_NEAR(Error("lift_and_drop", 200, true), 418.61e-3, 1e-3);
}

}  // namespace
}  // namespace mjdiag
