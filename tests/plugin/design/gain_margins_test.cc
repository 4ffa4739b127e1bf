#include "mjdiag/plugin/design/gain_margins.h"

#include <gtest/gtest.h>

#include <random>

#include "mjdiag/signals/error.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

class BonderMargins : public ::testing::Test {
 protected:
  const Machine bonder_ = test::Bonder();
  const FaultFamily family_ = MakeFaultFamily(bonder_);
  const GainMargins margins_ = FindGainMargins(bonder_, family_);
};

TEST_F(BonderMargins, HoldWhatAMotorLoses) {
  EXPECT_NEAR(margins_.healthy_radius, 0.98758, 5e-6);
  EXPECT_NEAR(margins_.time_constant, 0.010, 1e-4);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LT(margins_.least[i], 0.5);
    EXPECT_GT(margins_.most[i], 1.0 / 0.7);
  }
  // Twice the gain of x is 0.4 % from the unit circle, and further in a worn machine.
  EXPECT_LT(margins_.most[0], 2.0);
}

// Between the points of the grid as well.
TEST_F(BonderMargins, AreStableForAnyFaultAndGainWithin) {
  std::mt19937_64 generator(1);
  const FaultRange range;
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(generator);
  };
  double largest = 0.0;
  for (int run = 0; run < 400; ++run) {
    Eigen::VectorXd values = Eigen::VectorXd::Ones(7);
    for (int i = 0; i < 2; ++i) {
      values[i] = between(range.least_damping, range.most_damping);
      values[2 + i] = between(range.least_stiffness, range.most_stiffness);
    }
    Eigen::VectorXd gains(3);
    for (int i = 0; i < 3; ++i) gains[i] = between(margins_.least[i], margins_.most[i]);
    largest = std::max(largest, LoopRadius(bonder_, family_, values, gains));
  }
  EXPECT_LT(largest, 0.9965);
  EXPECT_GT(largest, 0.9);
}

// A gear is a gain.
TEST_F(BonderMargins, MeanByAGainWhatAMotorDoes) {
  Eigen::VectorXd weak = Eigen::VectorXd::Ones(7);
  weak[4] = 1.9;
  EXPECT_NEAR(LoopRadius(bonder_, family_, weak, Eigen::VectorXd::Ones(3)),
              LoopRadius(bonder_, family_, Eigen::VectorXd::Ones(7),
                         Eigen::Vector3d(1.9, 1.0, 1.0)),
              1e-9);
}

TEST(GainMargins, OfALoopThatIsNotStableAreRefused) {
  const Machine wild = test::Bonder({"axes.x.drive_gain=300.0"});
  EXPECT_THROW(FindGainMargins(wild, MakeFaultFamily(wild)), NumericalError);
}

TEST(GainMargins, OfOtherMachinesAreFound) {
  const Machine stage(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"));
  const GainMargins margins = FindGainMargins(stage, MakeFaultFamily(stage));
  EXPECT_LT(margins.least[0], 1.0);
  EXPECT_GT(margins.most[0], 1.0);
}

}  // namespace
}  // namespace mjdiag
