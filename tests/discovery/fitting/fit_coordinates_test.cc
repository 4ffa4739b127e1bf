#include "mjdiag/discovery/fitting/fit_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kDuration = 5.0;

// A force of which 20 N are expected, a factor, a velocity, a phase, a number of the plant.
const std::vector<FitParameter> kParameters = {
    {"force", Role::kAmplitude, 0.0, kNone, 0.0, 20.0},
    {"factor", Role::kFactor, 0.0, kNone, 1.0, 0.3},
    {"velocity", Role::kVelocity, 1e-3, 2.0},
    {"phase", Role::kPhase, -kNone, kNone},
    {"number", Role::kAmplitude, -10.0, 10.0, 0.0, 1.0}};
const VectorXd kTheta = (VectorXd(5) << 4.0, 0.5, 0.02, -1.0, -2.5).finished();

TEST(FitCoordinates, LeadBackToTheParameters) {
  const auto own = FitCoordinates::About(kParameters, kTheta, kDuration);
  EXPECT_TRUE(own.ToTheta(own.FromTheta(kTheta)).isApprox(kTheta, 1e-14));
  const auto plain = FitCoordinates::Plain(kTheta.size());
  EXPECT_EQ(plain.FromTheta(kTheta), kTheta);
}

TEST(FitCoordinates, HaveTheSlopeThatDifferencesHave) {
  const auto own = FitCoordinates::About(kParameters, kTheta, kDuration);
  const VectorXd x = own.FromTheta(kTheta);
  const VectorXd slope = own.SlopeAt(kTheta);
  constexpr double kStep = 1e-6;
  for (Index i = 0; i < x.size(); ++i) {
    VectorXd moved = x;
    moved[i] += kStep;
    const VectorXd change = (own.ToTheta(moved) - kTheta) / kStep;
    EXPECT_NEAR(change[i], slope[i], 1e-5 * std::abs(slope[i])) << i;
    EXPECT_EQ(change.cwiseAbs().sum(), std::abs(change[i])) << i;
  }
}

TEST(FitCoordinates, CountInWhatIsExpected) {
  const auto own = FitCoordinates::About(kParameters, kTheta, kDuration);
  const VectorXd slope = own.SlopeAt(kTheta);
  EXPECT_DOUBLE_EQ(slope[0], 20.0);
  EXPECT_DOUBLE_EQ(slope[1], 0.3 * 0.5);
  EXPECT_DOUBLE_EQ(slope[4], 1.0);
}

// Half the force and twice the mass with twice the friction are the same.
TEST(FitCoordinates, LayWhatMultipliesOnALine) {
  const auto own = FitCoordinates::About(kParameters, kTheta, kDuration);
  VectorXd half = kTheta;
  half[1] *= 0.5;
  VectorXd quarter = half;
  quarter[1] *= 0.5;
  const double step = own.FromTheta(half)[1] - own.FromTheta(kTheta)[1];
  EXPECT_NEAR(own.FromTheta(quarter)[1] - own.FromTheta(half)[1], step, 1e-12);
}

TEST(FitCoordinates, HaveTheBoundsOfTheParameters) {
  const auto own = FitCoordinates::About(kParameters, kTheta, kDuration);
  EXPECT_DOUBLE_EQ(own.Bound(2, 2.0), std::log(2.0));
  EXPECT_EQ(own.Bound(1, 0.0), -kNone);
  EXPECT_EQ(own.Bound(1, kNone), kNone);
  EXPECT_EQ(own.Bound(3, -kNone), -kNone);
  EXPECT_DOUBLE_EQ(own.Bound(4, 10.0), 10.0);
}

}  // namespace
}  // namespace mjdiag
