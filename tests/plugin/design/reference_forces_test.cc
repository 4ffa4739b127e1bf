#include "mjdiag/plugin/design/reference_forces.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <complex>

#include "support/bonder.h"

namespace mjdiag {
namespace {

// The published gains are those of the machine by itself; of the masses they have 2 %
// less or 1 % more.
TEST(ReferenceForces, AreTheFeedforwardOfTheBonder) {
  const Machine bonder = test::Bonder();
  const auto forces = ReferenceForcesOf(bonder.linear(), bonder.setup());
  for (Eigen::Index i = 0; i < 2; ++i) {
    const AxisSetup& axis = bonder.setup().control.axes[static_cast<std::size_t>(i)];
    const double newton = axis.drive_gain;
    EXPECT_NEAR(forces[1](i, i), newton * axis.feedforward.velocity,
                1e-4 * forces[1](i, i));
    EXPECT_NEAR(forces[2](i, i), newton * axis.feedforward.acceleration,
                0.03 * forces[2](i, i));
  }
}

// Of a transfer function that is not expanded.
TEST(ReferenceForces, AreThoseOfTheInverseAtALowFrequency) {
  const Machine bonder = test::Bonder();
  const MechanicalModel& model = bonder.linear();
  const auto forces = ReferenceForcesOf(model, bonder.setup());
  const std::complex<double> s(0.0, 2.0 * 3.14159 * 5.0);
  const Eigen::MatrixXcd dynamic = model.M * s * s + model.D * s + model.K;
  const Eigen::MatrixXcd transfer =
      model.b.transpose() *
      dynamic.partialPivLu().solve(model.Gamma.cast<std::complex<double>>());
  Eigen::MatrixXcd inverse = Eigen::MatrixXcd::Zero(3, 3);
  std::complex<double> power = 1.0;
  for (const Eigen::MatrixXd& force : forces) {
    inverse += power * force;
    power *= s;
  }
  EXPECT_LT((transfer * inverse - Eigen::MatrixXcd::Identity(3, 3)).norm(), 1e-6);
}

}  // namespace
}  // namespace mjdiag
