#include "mjdiag/plugin/replay/observer.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "plugin/replay/replay.h"
#include "support/bonder.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Observer Design(const Machine& machine, const MechanicalModel& model,
                const VectorXd& noise_sd, double bandwidth) {
  const Rates& rates = machine.rates();
  return DesignObserver(model, rates.step(), rates.substeps, noise_sd, bandwidth);
}

TEST(Observer, IsStableOnTheBonderAtAnyBandwidth) {
  const Machine bonder = test::Bonder();
  for (const double bandwidth : {2.0, 10.0, 160.0, 800.0}) {
    const Observer observer =
        Design(bonder, bonder.linear(), VectorXd::Constant(3, 2e-8), bandwidth);
    const MatrixXd F = observer.tick.A - observer.L * observer.tick.C;
    EXPECT_LT(SpectralRadius(F), 1.0) << bandwidth;
  }
}

// The gain solves the Riccati equation: one step of the plain recursion from its
// covariance, rebuilt from the gain by a Lyapunov sum, gives the same gain again.
TEST(Observer, HasTheStationaryGainOfTheKalmanPredictor) {
  const test::Stage stage;
  const MechanicalModel& model = stage.machine.linear();
  const double r = 1e-8;
  const double bandwidth = 5.0;
  const Observer observer =
      Design(stage.machine, model, VectorXd::Constant(1, r), bandwidth);
  const double omega = 2.0 * 3.141592653589793 * bandwidth;
  const double acceleration = (model.b.transpose() * Solve(model.M, model.Gamma))(0);
  const double force = omega * omega * r / std::abs(acceleration);
  const MatrixXd& A = observer.tick.A;
  const MatrixXd& C = observer.tick.C;
  MatrixXd P = MatrixXd::Zero(2, 2);
  MatrixXd L;
  for (int i = 0; i < 20000; ++i) {
    L = A * P * C.transpose() / ((C * P * C.transpose())(0) + r * r);
    P = A * P * A.transpose() - L * C * P * A.transpose() +
        force * force * observer.tick.B * observer.tick.B.transpose();
  }
  EXPECT_LT((observer.L - L).norm(), 1e-6 * L.norm());
}

// Bound: of n samples the variance is known to sqrt(2 / n) of itself; five of them.
TEST(Observer, KnowsTheSpreadOfInnovationsOfATrueModel) {
  const test::Stage stage;
  const test::Replay replay(stage.machine, stage.Measure({}));
  const VectorXd residual = replay.Scaled(replay.Follow({}));
  const auto n = static_cast<double>(residual.size());
  EXPECT_NEAR(residual.squaredNorm() / n, 1.0, 5.0 * std::sqrt(2.0 / n) + 0.03);
}

TEST(Observer, RefusesAMotionThatNoSensorSees) {
  const test::Stage stage;
  MechanicalModel model = stage.machine.linear();
  model.b.setZero();
  EXPECT_THROW(DesignObserver(model, 5e-4, 1, VectorXd::Constant(1, 1e-8), 5.0),
               NumericalError);
  EXPECT_THROW(DesignObserver(model, 5e-4, 1, VectorXd::Zero(1), 5.0), InputError);
  EXPECT_THROW(DesignObserver(model, 5e-4, 1, VectorXd::Constant(1, 1e-8), 1000.0),
               InputError);
}

}  // namespace
}  // namespace mjdiag
