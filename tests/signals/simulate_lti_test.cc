#include "mjdiag/signals/simulate_lti.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

StateSpace System() {
  StateSpace system;
  system.A = MatrixXd{{0.5, 0.25}, {0.0, -0.5}};
  system.B = MatrixXd{{1.0, 0.0}, {0.0, 2.0}};
  system.C = MatrixXd{{1.0, 1.0}, {0.0, 1.0}, {0.0, 0.0}};
  system.D = MatrixXd{{0.0, 0.0}, {0.0, 0.0}, {3.0, 0.0}};
  system.sample_time = 0.1;
  return system;
}

TEST(SimulateLti, FollowsTheDifferenceEquation) {
  // x: (4,8) -> (2+2+1, -4+0) = (5,-4) -> (2.5-1+0, 2+2) = (1.5, 4)
  const MatrixXd inputs{{1.0, 0.0, 2.0}, {0.0, 1.0, 0.0}};
  const MatrixXd outputs = SimulateLti(System(), inputs, Eigen::Vector2d(4.0, 8.0));
  EXPECT_EQ(outputs, (MatrixXd{{12.0, 1.0, 5.5}, {8.0, -4.0, 4.0}, {3.0, 0.0, 6.0}}));
}

TEST(SimulateLti, StartsAtRest) {
  EXPECT_EQ(SimulateLti(System(), MatrixXd::Zero(2, 5)), MatrixXd::Zero(3, 5));
}

TEST(SimulateLti, SaysWhereItDiverges) {
  StateSpace system = System();
  system.A(0, 0) = 1e200;
  EXPECT_THAT([&] { SimulateLti(system, MatrixXd::Ones(2, 9)); },
              testing::ThrowsMessage<NumericalError>(testing::HasSubstr("sample 3")));
}

TEST(SimulateLti, RefusesWhatDoesNotFit) {
  StateSpace continuous = System();
  continuous.sample_time = 0.0;
  StateSpace misshapen = System();
  misshapen.C = MatrixXd::Zero(3, 3);
  const MatrixXd inputs = MatrixXd::Zero(2, 4);
  EXPECT_THROW(SimulateLti(continuous, inputs), InputError);
  EXPECT_THROW(SimulateLti(misshapen, inputs), InputError);
  EXPECT_THROW(SimulateLti(System(), MatrixXd::Zero(3, 4)), InputError);
  EXPECT_THROW(SimulateLti(System(), inputs, Eigen::Vector3d::Zero()), InputError);
}

TEST(LtiStepper, ResetsToAnyState) {
  LtiStepper stepper(System());
  const double input[] = {1.0, 2.0};
  double first[3];
  double again[3];
  stepper.Reset(std::vector<double>{4.0, 8.0});
  stepper.Step(input, first);
  stepper.Step(input, again);
  stepper.Reset(std::vector<double>{4.0, 8.0});
  stepper.Step(input, again);
  EXPECT_THAT(again, testing::ElementsAreArray(first));
  stepper.Reset();
  EXPECT_EQ(stepper.state(), Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace mjdiag
