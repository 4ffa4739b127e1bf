#include "mjdiag/plugin/effects/regressor_signals.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/simulate_lti.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

/// Displacements of joint 0 of the linear plant under a force on joint 1.
Eigen::VectorXd Motion(MechanicalModel model, const Eigen::VectorXd& force,
                       double step) {
  model.Gamma = Eigen::Vector2d(0.0, 1.0);
  model.b = Eigen::Vector2d(1.0, 0.0);
  return SimulateLti(TickModel(model, step, 1), force.transpose()).row(0);
}

// The spring is halved: the resonance of 22 Hz falls to 16 Hz, far beyond its width.
TEST(RegressorSignals, MotionWithASpringIsThatOfThePlantThatHasIt) {
  MechanicalModel model;
  model.M = Eigen::Vector2d(2.0, 1.0).asDiagonal();
  model.D = Eigen::Vector2d(4.0, 20.0).asDiagonal();
  model.K = Eigen::Matrix2d{{4e4, -1e3}, {-1e3, 2e4}};
  MechanicalModel soft = model;
  soft.K(0, 0) -= 2e4;
  const double step = 1e-4;
  const Eigen::VectorXd force = GaussianNoise(20000, 1.0, 1, 0.99);
  const Eigen::VectorXd present = Motion(model, force, step);
  const Eigen::VectorXd wanted = Motion(soft, force, step);
  const Eigen::VectorXd moved = MotionWithSpring(model, 0, -2e4, present, step, step);
  ASSERT_GT((present - wanted).norm(), 0.5 * wanted.norm());
  EXPECT_LT((moved - wanted).norm(), 1e-9 * wanted.norm());
}

}  // namespace
}  // namespace mjdiag
