#include "mjdiag/diagnosis/twin/moved_rest.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kSpring = 800.0;  // N/m
constexpr double kSag = 0.012;     // m, under the weight of what hangs on it

/// A mass on a spring, which its weight stretches, and one beside it that nothing holds.
MechanicalModel HangingMass() {
  MechanicalModel model;
  model.M = Vector2d(1.0, 3.0).asDiagonal();
  model.D = MatrixXd::Zero(2, 2);
  model.K = Vector2d(kSpring, 0.0).asDiagonal();
  model.Gamma = MatrixXd::Identity(2, 2);
  model.b = MatrixXd::Identity(2, 2);
  return model;
}

/// Its spring, and its weight.
std::vector<ModelPart> Numbers() {
  ModelPart spring;
  spring.K = Vector2d(kSpring, 0.0).asDiagonal();
  spring.force = Vector2d(-kSpring * kSag, 0.0);
  spring.factors = {0};
  ModelPart weight;
  weight.force = Vector2d(kSpring * kSag, 0.0);
  weight.factors = {1};
  return {spring, weight};
}

TEST(MovedRest, IsWhereSpringAndWeightBalance) {
  MovedRest rest(HangingMass(), Numbers(), 2);
  const VectorXd theta = Vector2d(0.3, -0.2);
  rest.Find(theta);
  EXPECT_NEAR(rest.position()[0], kSag * (std::exp(theta[1] - theta[0]) - 1.0), 1e-15);
  EXPECT_EQ(rest.position()[1], 0.0);
}

TEST(MovedRest, KnowsHowItGoesWithEveryNumber) {
  MovedRest rest(HangingMass(), Numbers(), 2);
  const VectorXd theta = Vector2d(0.3, -0.2);
  rest.Find(theta);
  const double stretched = kSag * std::exp(theta[1] - theta[0]);
  EXPECT_NEAR(rest.sensitivity()(0, 0), -stretched, 1e-15);
  EXPECT_NEAR(rest.sensitivity()(0, 1), stretched, 1e-15);
  EXPECT_TRUE(rest.sensitivity().row(1).isZero(0.0));
}

TEST(MovedRest, StaysWhereNoNumberMovesIt) {
  std::vector<ModelPart> numbers = Numbers();
  for (ModelPart& number : numbers) number.force.resize(0);
  MovedRest rest(HangingMass(), numbers, 2);
  rest.Find(Vector2d(0.3, -0.2));
  EXPECT_TRUE(rest.position().isZero(0.0));
  EXPECT_TRUE(rest.sensitivity().isZero(0.0));
}

}  // namespace
}  // namespace mjdiag
