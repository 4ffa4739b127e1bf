// Friction in proportion to what a drive transmits.

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/trial.h"
#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

constexpr double kStiff = 1e3;  // N/m, of the bench with a spring

// Under u alone nothing else acts: the bound is c u, which holds for c > 1 and leaves
// (1 - c) u to accelerate with for c < 1.
TEST(LoadFriction, LeavesAMotorThatMovesAFreeMassItsShare) {
  EffectBench bench({"load_friction@q:coefficient=0.3"});
  bench.StepUntil(0.1, 4.0);
  EXPECT_NEAR(bench.v(), 0.7 * 4.0 / EffectBench::kMass * 0.1, 1e-4);
}

TEST(LoadFriction, HoldsWhatItsCoefficientIsLargeEnoughFor) {
  EffectBench bench({"load_friction@q:coefficient=1.5"});
  bench.StepUntil(0.5, 40.0);
  EXPECT_LT(std::abs(bench.q()), 1e-4);
}

TEST(LoadFriction, IsNotThereWithoutLoad) {
  EffectBench bench({"load_friction@q:coefficient=0.9"});
  bench.v() = 0.05;
  bench.StepUntil(0.1);
  EXPECT_NEAR(bench.v(), 0.05, 1e-9);
}

// A motor that holds a spring at q transmits u + k q, twice its own force: the joint
// stays where it is as long as |u - k q| < c |u + k q|.
TEST(LoadFriction, CountsTheForceOfASpringAgainstThatOfTheMotor) {
  const double q = 0.01;
  for (const double share : {0.9, 1.1}) {
    EffectBench bench({"load_friction@q:coefficient=0.2"},
                      R"(type="slide" stiffness="1000")");
    bench.q() = q;
    // (k q - u) / (k q + u) = share c
    const double part = share * 0.2;
    const double u = kStiff * q * (1.0 - part) / (1.0 + part);
    bench.StepUntil(0.02, u);
    if (share < 1.0) {
      EXPECT_NEAR(bench.q(), q, 1e-5);
    } else {
      EXPECT_LT(bench.q(), q - 2e-5);
    }
  }
}

TEST(LoadFriction, ShowsAlongAMotionAsItsBoundWithTheSignOfTheVelocity) {
  EffectBench bench({});
  MechanicalModel model;
  model.M = Eigen::MatrixXd::Constant(1, 1, EffectBench::kMass);
  model.Gamma = Eigen::MatrixXd::Ones(1, 1);
  ObservedMotion motion;
  motion.sample_time = 1e-3;
  motion.position = motion.velocity = motion.acceleration = Eigen::MatrixXd(1, 3);
  motion.velocity << 1.0, -1.0, 1.0;
  motion.acceleration << 1.0, 2.0, -1.0;
  motion.inputs = Eigen::MatrixXd(1, 3);
  motion.inputs << 2.0, 2.0, 2.0;
  const Site site{"q", 0, -1};
  const auto trials = LoadFriction().Trials({bench.model(), model, motion, site});
  ASSERT_EQ(trials.size(), 1u);
  // -|2 u - m a| sign(v)
  const Eigen::Vector3d expected(-2.0, 0.0, -6.0);
  EXPECT_LT((trials[0].signals.col(0) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ((*trials[0].values(Eigen::VectorXd::Constant(1, 0.1)))[0], 0.1);
  EXPECT_FALSE(trials[0].values(Eigen::VectorXd::Constant(1, -0.1)));
}

}  // namespace
}  // namespace mjdiag
