#include "mjdiag/diagnosis/model/dae_model.h"

#include <gtest/gtest.h>

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

/// [AB383], Example 2 with k = c = m = 1.
StateSpace MassSpringDamper() {
  StateSpace system;
  system.A = (Eigen::Matrix2d() << 0.0, 1.0, -1.0, -1.0).finished();
  system.B = Eigen::Vector2d(0.0, 1.0);
  system.C = Eigen::RowVector2d(1.0, 0.0);
  system.D = MatrixXd::Zero(1, 1);
  return system;
}

TEST(DaeModel, OfAStateSpaceIsEquation13) {
  const StateSpace system = MassSpringDamper();
  const SignalEntry disturbance{Eigen::Vector2d(0.0, 2.0),
                                MatrixXd::Constant(1, 1, 4.0)};
  const SignalEntry fault{Eigen::Vector2d(0.0, 3.0), MatrixXd::Constant(1, 1, 5.0)};
  const DaeModel dae = MakeDae(system, disturbance, fault);
  const std::complex<double> s(0.3, 2.0);
  Eigen::Matrix3cd expected;
  expected << -s, 1.0, 0.0, -1.0, -s - 1.0, 2.0, 1.0, 0.0, 4.0;
  EXPECT_TRUE(dae.H.At(s).isApprox(expected));
  MatrixXd known(3, 2);
  known << 0.0, 0.0, 0.0, 1.0, -1.0, 0.0;
  EXPECT_EQ(dae.L.coefficients[0], known);
  EXPECT_EQ(dae.F.coefficients[0], MatrixXd(Eigen::Vector3d(0.0, 3.0, 5.0)));
}

TEST(DaeModel, BarMatrixMultipliesCoefficients) {
  const DaeModel dae = MakeDae(MassSpringDamper());
  PolynomialMatrix row;
  row.coefficients = {Eigen::RowVector3d(1.0, 2.0, 3.0),
                      Eigen::RowVector3d(-1.0, 0.5, 4.0)};
  Eigen::RowVectorXd stacked(6);
  stacked << row.coefficients[0], row.coefficients[1];
  const Eigen::RowVectorXd product = stacked * BarMatrix(dae.H, 1);
  const PolynomialMatrix expected = row * dae.H;
  ASSERT_EQ(product.size(), 6);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_TRUE(product.segment(2 * i, 2).isApprox(
        expected.coefficients[static_cast<std::size_t>(i)]));
  }
}

TEST(DaeModel, BarMatrixAnnihilatesTheRelationOfExample4) {
  // N = [s + 1, 1, s^2 + s + 1]
  const DaeModel dae = MakeDae(MassSpringDamper());
  Eigen::RowVectorXd row(9);
  row << 1, 1, 1, 1, 0, 1, 0, 0, 1;
  EXPECT_EQ((row * BarMatrix(dae.H, 2)).cwiseAbs().maxCoeff(), 0.0);
}

TEST(PolynomialMatrix, ProductEvaluatesToTheProduct) {
  PolynomialMatrix a{{MatrixXd::Random(2, 3), MatrixXd::Random(2, 3)}};
  PolynomialMatrix b{
      {MatrixXd::Random(3, 1), MatrixXd::Random(3, 1), MatrixXd::Random(3, 1)}};
  const std::complex<double> s(-0.4, 1.7);
  EXPECT_EQ((a * b).degree(), 3);
  EXPECT_TRUE((a * b).At(s).isApprox(a.At(s) * b.At(s), 1e-14));
}

}  // namespace
}  // namespace mjdiag
