#include "mjdiag/plugin/draft/force_balance.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plugin/draft/swung_arm.h"

namespace mjdiag {
namespace {

class ForceBalance : public ::testing::Test {
 protected:
  ForceBalance() {
    model_ = LoadModel(folder_.Write("arm.xml", test::Arm(test::kMotor)));
    motion_.sample_time = 0.002;
    motion_.positions.resize(1, 2000);
    motion_.controls.resize(1, 2000);
    motion_.forces.setZero(1, 2000);
    test::SwungLog("", [this](const test::SwungMoment& moment) {
      motion_.positions(0, next_) = moment.angle;
      motion_.controls(0, next_++) = moment.torque;
      return std::string();
    });
  }
  double Imbalance(int lag = 0) const { return *ForceImbalance(*model_, motion_, lag); }

  test::TemporaryFolder folder_;
  ModelPtr model_;
  LoggedMotion motion_;
  Eigen::Index next_ = 0;
};

TEST_F(ForceBalance, ClosesOnWhatColumnsAre) { EXPECT_LT(Imbalance(), 0.05); }

TEST_F(ForceBalance, IsOpenWhereDegreesAreTakenForRadians) {
  motion_.positions *= 180.0 / std::numbers::pi;
  EXPECT_GT(Imbalance(), 0.5);
}

TEST_F(ForceBalance, IsOpenWhereASignIsWrong) {
  motion_.controls *= -1.0;
  EXPECT_GT(Imbalance(), 0.5);
}

TEST_F(ForceBalance, CountsForcesThatNoActuatorGives) {
  motion_.forces = motion_.controls;
  motion_.controls.setZero();
  EXPECT_LT(Imbalance(), 0.05);
}

TEST_F(ForceBalance, SaysNothingOfAMachineThatStands) {
  motion_.positions.setConstant(0.1);
  motion_.controls.setZero();
  EXPECT_FALSE(ForceImbalance(*model_, motion_));
}

}  // namespace
}  // namespace mjdiag
