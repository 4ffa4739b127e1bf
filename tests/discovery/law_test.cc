#include "mjdiag/discovery/law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/plugin/effects/fault_effect.h"
#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Of -2 to 3, without anything explained.
Eigen::MatrixX2d Curve(const Cause& cause) {
  return LawCurve(cause, VectorXd::LinSpaced(100, -2.0, 3.0), VectorXd::Zero(100));
}

TEST(LawCurve, IsTheForceThatTheEffectMakesOnAJoint) {
  for (const char* effect :
       {"viscous_friction@q:coefficient=3",
        "asymmetric_viscous_friction@q:positive=3,negative=1.5",
        "quadratic_drag@q:coefficient=4", "force_offset@q:force=-2",
        "force_ripple@q:amplitude=2,period=0.7,phase=0.4",
        "linear_stiffness@q:stiffness=30", "cubic_stiffness@q:coefficient=20",
        "end_stop@q:position=1.2,stiffness=50",
        "end_stop@q:position=-0.7,stiffness=50"}) {
    SCOPED_TRACE(effect);
    const Cause cause = ParseEffect(effect);
    const bool of_velocity = cause.effect->variable() == LawVariable::kVelocity;
    test::EffectBench bench({effect});
    const Eigen::MatrixX2d curve = Curve(cause);
    EXPECT_EQ(curve(0, 0), -2.0);
    EXPECT_EQ(curve(curve.rows() - 1, 0), 3.0);
    for (Index i = 0; i < curve.rows(); i += 7) {
      const double x = curve(i, 0);
      const double force = bench.ForceAt(of_velocity ? 0.0 : x, of_velocity ? x : 0.0);
      EXPECT_NEAR(curve(i, 1), force, 1e-9 * (1.0 + std::abs(force))) << "at " << x;
    }
    EXPECT_GT(curve.col(1).cwiseAbs().maxCoeff(), 1.0);
  }
}

// Dry friction is no function at rest: a constraint holds the joint.
TEST(LawCurve, OfDryFrictionIsAgainstTheMotion) {
  const Eigen::MatrixX2d coulomb = Curve(ParseEffect("coulomb_friction@q:force=5"));
  const Eigen::MatrixX2d stribeck =
      Curve(ParseEffect("stribeck_friction@q:coulomb=5,breakaway=2,velocity=0.5"));
  for (Index i = 0; i < coulomb.rows(); ++i) {
    const double v = coulomb(i, 0);
    EXPECT_EQ(coulomb(i, 1), v > 0.0 ? -5.0 : 5.0) << v;
    EXPECT_NEAR(stribeck(i, 1) / coulomb(i, 1), 1.0 + 0.4 * std::exp(-4.0 * v * v),
                1e-12)
        << v;
  }
}

// Its own inertia does not accelerate a mass; the plant's has to.
TEST(LawCurve, OfAMassIsAgainstTheAcceleration) {
  const Eigen::MatrixX2d curve = Curve(ParseEffect("added_mass@q:mass=0.3"));
  EXPECT_LT((curve.col(1) + 0.3 * curve.col(0)).norm(), 1e-12);
}

TEST(LawCurve, WithoutAClosedFormIsTheMeanOfWhatTheCauseExplains) {
  const Cause fault{FaultEffect({"zeta", ModelParameterKind::kDamping, {0}}), "q",
                    Eigen::VectorXd::Constant(1, 1.2)};
  // Neither in order nor evenly spaced.
  const VectorXd x = VectorXd::LinSpaced(4000, 0.0, 40.0).array().sin();
  const VectorXd noise = VectorXd::LinSpaced(4000, 0.0, 1e4).array().cos();
  const Eigen::MatrixX2d curve = LawCurve(fault, x, 2.0 * x + noise);
  ASSERT_GT(curve.rows(), 10);
  for (Index i = 0; i < curve.rows(); ++i) {
    if (i > 0) {
      EXPECT_GT(curve(i, 0), curve(i - 1, 0));
    }
    EXPECT_NEAR(curve(i, 1), 2.0 * curve(i, 0), 0.35) << i;
  }
  // Bins hold the same number of samples each.
  EXPECT_NEAR(curve.col(0).mean(), x.mean(), 1e-12);
}

/// Two joints, one actuator, three samples.
ObservedMotion Motion() {
  ObservedMotion motion;
  motion.sample_time = 0.5;
  motion.time = Eigen::Vector3d(0.0, 0.5, 1.0);
  motion.position = (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished();
  motion.velocity = 10.0 * motion.position;
  motion.acceleration = 100.0 * motion.position;
  motion.inputs = (Eigen::MatrixXd(1, 3) << 7, 8, 9).finished();
  return motion;
}

TEST(AxisOf, IsWhatTheLawDependsOnAtItsJointOrActuator) {
  Candidate candidate;
  candidate.joint = 1;
  const ObservedMotion motion = Motion();
  const auto axis = [&](LawVariable variable, bool hinge) {
    return AxisOf(variable, candidate, motion, hinge, "V");
  };
  EXPECT_EQ(axis(LawVariable::kPosition, true).x, motion.position.row(1).transpose());
  EXPECT_EQ(axis(LawVariable::kPosition, true).unit, "rad");
  EXPECT_EQ(axis(LawVariable::kVelocity, false).x, motion.velocity.row(1).transpose());
  EXPECT_EQ(axis(LawVariable::kVelocity, false).unit, "m/s");
  EXPECT_EQ(axis(LawVariable::kAcceleration, true).x,
            motion.acceleration.row(1).transpose());
  EXPECT_EQ(axis(LawVariable::kAcceleration, true).unit, "rad/s^2");
  EXPECT_EQ(axis(LawVariable::kTime, false).x, Eigen::Vector3d(0.0, 0.5, 1.0));
  // Of an actuator only where the candidate acts there.
  EXPECT_EQ(axis(LawVariable::kInput, false).name, "time");
  candidate.channel = 0;
  EXPECT_EQ(axis(LawVariable::kInput, false).x, Eigen::Vector3d(7.0, 8.0, 9.0));
  EXPECT_EQ(axis(LawVariable::kInput, false).unit, "V");
}

}  // namespace
}  // namespace mjdiag
