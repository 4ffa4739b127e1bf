// A robot arm, really measured. The data belongs to its authors and is not part of this
// repository: the folder is named by MJDIAG_PANDA_DATA, see docs/own-machine.md.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/zero_phase.h"

namespace mjdiag {
namespace {

std::filesystem::path DataFile() {
  const char* named = std::getenv("MJDIAG_PANDA_DATA");
  return std::filesystem::path(named != nullptr ? named : "") / "exciting_motion.csv";
}

class Panda : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(DataFile())) return;
    GTEST_SKIP() << "no data of the arm: MJDIAG_PANDA_DATA names no folder with "
                    "exciting_motion.csv";
  }
};

// Against inverse dynamics of positions and torques that were filtered forwards and
// backwards at 10 Hz: what is missing is, too, for comparison.
TEST_F(Panda, LacksTheTorqueThatInverseDynamicsFinds) {
  const mjdiag::Setup setup = ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/panda");
  const Comparison comparison =
      Compare(Machine(setup), ReadMeasured(setup, DataFile().string()).record, {});
  ASSERT_TRUE(comparison.falls);
  const std::map<std::string, double> inverse = {
      {"joint1", 0.415}, {"joint2", 0.598}, {"joint3", 0.376}, {"joint4", 0.618},
      {"joint5", 0.339}, {"joint6", 0.184}, {"joint7", 0.279}};
  ASSERT_EQ(comparison.missing_force.size(), inverse.size());
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    const Eigen::VectorXd slow = FilterZeroPhase(
        DigitalButterworth(FilterKind::kLowPass, 4, 10.0, 1e-3), force.value);
    EXPECT_NEAR(Rms(slow), inverse.at(force.joint), 0.15 * inverse.at(force.joint))
        << force.joint;
  }
}

}  // namespace
}  // namespace mjdiag
