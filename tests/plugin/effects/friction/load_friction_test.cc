// Friction in proportion to what a drive transmits.

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/registry.h"
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
  motion.position = motion.velocity = motion.acceleration = Eigen::MatrixXd::Zero(1, 3);
  motion.velocity << 1.0, -1.0, 1.0;
  motion.acceleration << 1.0, 2.0, -1.0;
  motion.inputs = Eigen::MatrixXd(1, 3);
  motion.inputs << 2.0, 2.0, 2.0;
  const Site site{"q", 0, -1};
  const auto trials =
      LoadFriction().CandidateRegressors({bench.model(), model, motion, site});
  ASSERT_EQ(trials.size(), 1u);
  // -|2 u - m a| sign(v)
  const Eigen::Vector3d expected(-2.0, 0.0, -6.0);
  EXPECT_LT((trials[0].signals.col(0) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ((*trials[0].values(Eigen::VectorXd::Constant(1, 0.1)))[0], 0.1);
  EXPECT_EQ(trials[0].least, Eigen::VectorXd::Zero(1));  // it does not push
}

// The load of a spring at q against that of the motor, which has to overcome a friction of
// |motor_share u - load_share (-k q)| to leave where it is.
TEST(DirectionalLoadFriction, IsLessWhereTheMotorTurnsTheLoad) {
  const double q = 0.01;
  const double spring = kStiff * q;
  const auto moves = [&](double u) {
    EffectBench bench({"directional_load_friction@q:motor_share=0.05,load_share=0.4"},
                      R"(type="slide" stiffness="1000")");
    bench.q() = q;
    bench.StepUntil(0.02, u);
    return bench.q() - q;
  };
  // The spring wins below u = spring (1 - 0.4) / (1 + 0.05), the motor above
  // spring (1 + 0.4) / (1 - 0.05).
  const double down = spring * 0.6 / 1.05;
  const double up = spring * 1.4 / 0.95;
  EXPECT_LT(moves(0.9 * down), -2e-5);
  EXPECT_NEAR(moves(1.1 * down), 0.0, 1e-5);
  EXPECT_NEAR(moves(0.9 * up), 0.0, 1e-5);
  EXPECT_GT(moves(1.1 * up), 2e-5);
}

TEST(DirectionalLoadFriction, IsThatOfBothSidesWhereTheirSharesAreEqual) {
  const auto end = [](const char* effect) {
    EffectBench bench({effect}, R"(type="slide" stiffness="1000")");
    bench.q() = 0.02;
    bench.StepUntil(0.05, 3.0);
    return bench.q();
  };
  const double both = end("directional_load_friction@q:motor_share=0.2,load_share=0.2");
  EXPECT_EQ(both, end("load_friction@q:coefficient=0.2"));
  const auto simpler = DirectionalLoadFriction().Simpler(
      ParseEffect("directional_load_friction@q:motor_share=0.1,load_share=0.3"));
  EXPECT_EQ(FormatEffect(*simpler), "load_friction@q:coefficient=0.2");
}

TEST(QuadraticLoadFriction, LeavesAMotorThatMovesAFreeMassLessTheMoreItGives) {
  for (const double u : {1.0, 3.0}) {
    EffectBench bench({"quadratic_load_friction@q:coefficient=0.1"});
    bench.StepUntil(0.1, u);
    EXPECT_NEAR(bench.v(), (u - 0.1 * u * u) / EffectBench::kMass * 0.1, 1e-4);
  }
  EffectBench held({"quadratic_load_friction@q:coefficient=0.1"});
  held.StepUntil(0.1, 11.0);
  EXPECT_LT(std::abs(held.q()), 1e-4);
}

TEST(StribeckLoadFriction, FallsWithSpeed) {
  // Deceleration under a load that the motor makes: (1 - share) u accelerates.
  const auto gained = [](double speed) {
    EffectBench bench(
        {"stribeck_load_friction@q:coefficient=0.1,breakaway=0.4,velocity=0.5"});
    bench.v() = speed;
    bench.StepUntil(0.01, 1.0);
    return (bench.v() - speed) * EffectBench::kMass / 0.01;
  };
  EXPECT_NEAR(gained(5.0), 1.0 - 0.1, 1e-3);
  EXPECT_NEAR(gained(0.5), 1.0 - 0.1 - 0.4 * std::exp(-1.0), 5e-3);
  EXPECT_NEAR(gained(0.02), 1.0 - 0.5, 5e-3);
}

TEST(GearLoadFriction, IsTheSumOfItsPartsAndFallsToTheDirectionalLawWithoutThem) {
  // The motor pushes with 2 N against nothing: rest is 0.
  const auto gained = [](const char* effect, double speed) {
    EffectBench bench({effect});
    bench.v() = speed;
    bench.StepUntil(0.01, 2.0);
    return (bench.v() - speed) * EffectBench::kMass / 0.01;
  };
  const char* all =
      "gear_load_friction@q:motor_share=0.1,load_share=0.3,quadratic=0.05";
  EXPECT_NEAR(gained(all, 5.0), 2.0 - 0.1 * 2.0 - 0.05 * 4.0, 1e-3);
  const auto simpler = GearLoadFriction().Simpler(ParseEffect(all));
  EXPECT_EQ(FormatEffect(*simpler),
            "directional_load_friction@q:motor_share=0.1,load_share=0.3");
}

}  // namespace
}  // namespace mjdiag
