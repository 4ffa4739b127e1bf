#include "mjdiag/diagnosis/left_null_space.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Five masses in a row, 0.1 to 1000 N/mm, force on the first, scales on the outer two.
MechanicalModel Row() {
  constexpr int kMasses = 5;
  const VectorXd mass = (VectorXd(kMasses) << 2.0, 0.4, 7.0, 1.0, 0.05).finished();
  const VectorXd spring = (VectorXd(kMasses) << 1e2, 1e4, 1e6, 3e5, 2e3).finished();
  MechanicalModel model;
  model.M = mass.asDiagonal();
  model.K = MatrixXd::Zero(kMasses, kMasses);
  for (int i = 0; i < kMasses; ++i) {
    model.K(i, i) += spring[i];
    if (i == 0) continue;
    model.K(i - 1, i - 1) += spring[i];
    model.K(i, i - 1) = model.K(i - 1, i) = -spring[i];
  }
  model.D = 1e-4 * model.K + 0.1 * model.M;
  model.Gamma = VectorXd::Unit(kMasses, 0);
  model.b = MatrixXd::Zero(kMasses, 2);
  model.b(0, 0) = model.b(4, 1) = 1.0;
  model.inputs = {"u"};
  model.outputs = {"y1", "y5"};
  return model;
}

TEST(ObservabilityRanks, GrowByTheOutputsUntilAResidualExists) {
  // The middle mass is reached from either scale through two springs with their
  // dampers. All springs have the same ratio of damping to stiffness, so those factors
  // cancel, and equating both ways gives one residual of degree 4: one of the ten rows
  // of that degree is not new.
  const MechanicalModel model = Row();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_EQ(ObservabilityRanks(system, 6), (std::vector<int>{2, 4, 6, 8, 9, 10, 10}));
}

TEST(ObservabilityRanks, SeeWhatNoSensorSees) {
  // Without the coupling the last mass is out of sight of the first scale.
  MechanicalModel model = Row();
  model.K(3, 4) = model.K(4, 3) = model.D(3, 4) = model.D(4, 3) = 0.0;
  model.b = model.b.leftCols(1).eval();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_EQ(ObservabilityRanks(system, 9).back(), 8);
}

TEST(LeftNullRow, AnnihilatesH) {
  const MechanicalModel model = Row();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  const PolynomialMatrix row = LeftNullRow(system, 4, {{1, 4, 1.0}});
  const PolynomialMatrix product = row * MakeDae(system).H;
  double largest = 0.0;
  for (const MatrixXd& coefficient : row.coefficients) {
    largest = std::max(largest, coefficient.cwiseAbs().maxCoeff());
  }
  for (const MatrixXd& coefficient : product.coefficients) {
    EXPECT_LT(coefficient.cwiseAbs().maxCoeff(), 1e-12 * largest);
  }
  EXPECT_DOUBLE_EQ(row.coefficients[4](0, system.states() + 1), 1.0);
}

TEST(LeftNullRow, RefusesPinsThatLeaveAChoice) {
  const MechanicalModel model = Row();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_THROW(LeftNullRow(system, 5, {{1, 5, 1.0}}), NumericalError);
}

TEST(LeftNullRow, RefusesPinsThatNoRowHas) {
  // Below the observability index there is no residual at all.
  const MechanicalModel model = Row();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_THROW(LeftNullRow(system, 3, {{1, 3, 1.0}}), NumericalError);
}

TEST(PinnedResidualRow, IsZeroOnTheMachinesOwnResponse) {
  // r_y(s) G(s) + r_u(s) = 0 at any s, in SI units.
  const MechanicalModel model = Row();
  const ResidualRow row = PinnedResidualRow(model, 5, {{0, 5, 0.0}, {1, 0, -3e7}});
  EXPECT_NEAR(row.outputs(1, 0), -3e7, 1.0);
  const std::complex<double> s(3.0, 40.0);
  const Eigen::MatrixXcd stiffness =
      s * s * model.M + s * model.D + Eigen::MatrixXcd(model.K);
  const Eigen::VectorXcd response =
      model.b.transpose() *
      stiffness.partialPivLu().solve(Eigen::MatrixXcd(model.Gamma));
  std::complex<double> residual = 0.0;
  double size = 0.0;
  for (int k = 0; k <= 5; ++k) {
    const std::complex<double> power = std::pow(s, k);
    for (int i = 0; i < 2; ++i) {
      residual += row.outputs(i, k) * power * response[i];
      size += std::abs(row.outputs(i, k) * power * response[i]);
    }
    residual += row.inputs(0, k) * power;
    size += std::abs(row.inputs(0, k) * power);
  }
  EXPECT_LT(std::abs(residual), 1e-11 * size);
}

}  // namespace
}  // namespace mjdiag
