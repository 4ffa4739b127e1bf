#include "mjdiag/diagnosis/model/mechanical_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two masses in a row, the first tied to the ground, force and scale on the second.
MechanicalModel TwoMasses() {
  MechanicalModel model;
  model.M = Eigen::Vector2d(2.0, 0.5).asDiagonal();
  model.D = (Eigen::Matrix2d() << 3.0, -1.0, -1.0, 1.0).finished();
  model.K = (Eigen::Matrix2d() << 500.0, -200.0, -200.0, 200.0).finished();
  model.Gamma = Eigen::Vector2d(0.0, 1.0);
  model.b = Eigen::Vector2d(0.0, 1.0);
  return model;
}

MechanicalModel Oscillator(double mass, double damping, double stiffness) {
  const auto scalar = [](double value) { return MatrixXd::Constant(1, 1, value); };
  MechanicalModel model;
  model.M = scalar(mass);
  model.D = scalar(damping);
  model.K = scalar(stiffness);
  model.Gamma = scalar(1.0);
  model.b = scalar(1.0);
  return model;
}

TEST(Modes, OfAnOscillatorHaveItsFrequencyAndDampingRatio) {
  const std::vector<Mode> modes = Modes(Oscillator(2.0, 4.0, 800.0));
  ASSERT_EQ(modes.size(), 1u);
  EXPECT_NEAR(modes[0].frequency, 20.0 / (2.0 * std::numbers::pi), 1e-13);
  EXPECT_NEAR(modes[0].damping_ratio, 4.0 / (2.0 * std::sqrt(2.0 * 800.0)), 1e-14);
}

TEST(Modes, OverdampedPairAppearsAsTwo) {
  // (s + 1)(s + 3)
  const std::vector<Mode> modes = Modes(Oscillator(1.0, 4.0, 3.0));
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0].frequency, 1.0 / (2.0 * std::numbers::pi), 1e-14);
  EXPECT_NEAR(modes[1].frequency, 3.0 / (2.0 * std::numbers::pi), 1e-14);
  EXPECT_DOUBLE_EQ(modes[1].damping_ratio, 1.0);
}

TEST(Modes, LeaveRigidBodyPolesOut) {
  EXPECT_EQ(Modes(Oscillator(1.0, 0.0, 0.0)).size(), 0u);
  EXPECT_EQ(Modes(Oscillator(95.1, 203.5, 0.0)).size(), 1u);
}

TEST(Modes, ShapeIsThatOfTheUndampedEigenvector) {
  MechanicalModel model = TwoMasses();
  model.D.setZero();
  for (const Mode& mode : Modes(model)) {
    const double w2 = std::pow(2.0 * std::numbers::pi * mode.frequency, 2);
    // Row 1 of (K - w^2 M) q = 0 gives the ratio of the amplitudes.
    EXPECT_NEAR(mode.shape[1] / mode.shape[0], std::abs((500.0 - 2.0 * w2) / 200.0),
                1e-9);
    EXPECT_DOUBLE_EQ(mode.shape.maxCoeff(), 1.0);
  }
}

TEST(ContinuousStateSpace, SatisfiesTheEquationsOfMotion) {
  const MechanicalModel model = TwoMasses();
  const StateSpace system = ContinuousStateSpace(model);
  const VectorXd state = Eigen::Vector4d(0.3, -0.2, 0.7, 1.1);
  const VectorXd input = VectorXd::Constant(1, 5.0);
  const VectorXd rate = system.A * state + system.B * input;
  EXPECT_TRUE(rate.head(2).isApprox(state.tail(2)));
  const VectorXd force =
      model.M * rate.tail(2) + model.D * state.tail(2) + model.K * state.head(2);
  EXPECT_TRUE(force.isApprox(model.Gamma * input, 1e-13));
  EXPECT_DOUBLE_EQ((system.C * state)[0], -0.2);
}

TEST(ContinuousStateSpace, RefusesAMassMatrixThatIsNotPositive) {
  MechanicalModel model = TwoMasses();
  model.M(0, 0) = -1.0;
  EXPECT_THROW(ContinuousStateSpace(model), NumericalError);
}

TEST(UnitMassStateSpace, HasTheSameTransferFunctionInItsUnitOfTime) {
  const MechanicalModel model = TwoMasses();
  constexpr double kTimeUnit = 0.05;
  const StateSpace seconds = ContinuousStateSpace(model);
  const StateSpace scaled = UnitMassStateSpace(model, kTimeUnit);
  const std::complex<double> s(1.0, 7.0);
  const auto response = [](const StateSpace& system, std::complex<double> at) {
    const Eigen::MatrixXcd pencil = at * Eigen::MatrixXcd::Identity(4, 4) - system.A;
    return (system.C * SolveComplex(pencil, Eigen::MatrixXcd(system.B)))(0, 0);
  };
  EXPECT_LT(std::abs(response(seconds, s) - response(scaled, s * kTimeUnit)), 1e-15);
}

TEST(TickModel, IsTheSemiImplicitEulerRecursion) {
  const MechanicalModel model = TwoMasses();
  constexpr double kStep = 1e-3;
  constexpr int kSubsteps = 4;
  const StateSpace tick = TickModel(model, kStep, kSubsteps);
  VectorXd q = Eigen::Vector2d(0.3, -0.2);
  VectorXd v = Eigen::Vector2d(0.7, 1.1);
  const VectorXd u = VectorXd::Constant(1, 5.0);
  VectorXd state(4);
  state << q, v;
  const VectorXd predicted = tick.A * state + tick.B * u;
  for (int i = 0; i < kSubsteps; ++i) {
    const MatrixXd implicit = model.M + kStep * model.D;
    const VectorXd force = -model.K * q - model.D * v + model.Gamma * u;
    v += kStep * Solve(implicit, force);
    q += kStep * v;
  }
  EXPECT_TRUE(predicted.head(2).isApprox(q, 1e-13));
  EXPECT_TRUE(predicted.tail(2).isApprox(v, 1e-13));
  EXPECT_DOUBLE_EQ(tick.sample_time, kStep * kSubsteps);
  EXPECT_DOUBLE_EQ((tick.C * state)[0], -0.2);
}

}  // namespace
}  // namespace mjdiag
