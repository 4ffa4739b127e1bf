// Curves that are learned from a force: what they are over and where they begin.

#include "mjdiag/discovery/unexplained/learned_curve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// A joint that swings to and fro, with a force that follows what it does.
struct Swing {
  ObservedMotion motion;
  UnknownSignal force;
  std::vector<MotionVariable> variables;

  Swing(const Machine& machine, double (*law)(double q, double v)) {
    constexpr Eigen::Index kSamples = 4000;
    motion.sample_time = 1e-3;
    motion.time = VectorXd::LinSpaced(kSamples, 0.0, 4.0);
    const Eigen::ArrayXd t = motion.time;
    motion.position = (0.1 * (7.0 * t).sin() + 0.03 * (19.0 * t).cos()).transpose();
    motion.velocity = (0.7 * (7.0 * t).cos() - 0.57 * (19.0 * t).sin()).transpose();
    motion.acceleration = Eigen::MatrixXd::Zero(1, kSamples);
    motion.inputs = Eigen::MatrixXd::Zero(1, kSamples);
    force.site = "load";
    force.unit = "N";
    force.sd = 1e-3;
    force.value.resize(kSamples);
    for (Eigen::Index k = 0; k < kSamples; ++k) {
      force.value[k] = law(motion.position(0, k), motion.velocity(0, k));
    }
    variables = MotionVariables(machine, motion, {"load"}, 0, 1e-3, 1);
  }
  Signature Signed() const {
    return FindSignature("load", force.value, "N", force.sd,
                         {variables.begin(), variables.end()});
  }
  /// The force of the curve where it begins, at every sample.
  VectorXd Predicted(const LearnedCurve& curve) const {
    const VectorXd& chosen = curve.candidate.chosen;
    const CurveAxis axis = CurveAxisOf(chosen);
    VectorXd predicted = VectorXd::Zero(curve.x.size());
    for (Eigen::Index k = 0; k < predicted.size(); ++k) {
      const CurveAxis::Weights weights = axis.At(curve.x[k]);
      for (std::size_t i = 0; i < weights.place.size(); ++i) {
        predicted[k] += weights.weight[i] * curve.start[weights.place[i]];
      }
      predicted[k] *= FactorOf(static_cast<CurveFactor>(chosen[force_curve::kFactor]),
                               motion.velocity(0, k), chosen[force_curve::kStill]);
    }
    return predicted;
  }
};

TEST(LearnedCurve, FollowsASmoothForceOverAPosition) {
  const test::Stage stage;
  const Swing swing(stage.machine, [](double q, double) { return std::exp(-9.0 * q); });
  const auto curve = LearnCurve(swing.force, swing.Signed(), swing.variables,
                                swing.motion, 0, 10.0, 9);
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->over, "load position");
  EXPECT_LT((swing.Predicted(*curve) - swing.force.value).norm(),
            0.01 * swing.force.value.norm());
}

// What turns round with the direction: a tenth of its force is where it turns.
TEST(LearnedCurve, StepsWhereFrictionTurnsRound) {
  const test::Stage stage;
  const Swing swing(stage.machine, [](double, double v) {
    return (v > 0.0 ? -1.0 : 1.0) * std::sqrt(std::abs(v) + 0.1);
  });
  const auto curve = LearnCurve(swing.force, swing.Signed(), swing.variables,
                                swing.motion, 0, 10.0, 9);
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->over, "load velocity");
  EXPECT_EQ(curve->candidate.chosen[force_curve::kShape],
            static_cast<double>(CurveShapes::kSplit));
  EXPECT_LT((swing.Predicted(*curve) - swing.force.value).norm(),
            0.1 * swing.force.value.norm());
}

TEST(LearnedCurve, HasTheChoicesOfItsCandidateInTheCauseThatItBecomes) {
  const test::Stage stage;
  const Swing swing(stage.machine, [](double q, double v) { return 50.0 * q * q * v; });
  const auto curve = LearnCurve(swing.force, swing.Signed(), swing.variables,
                                swing.motion, 0, 10.0, 5);
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->candidate.chosen[force_curve::kFactor],
            static_cast<double>(CurveFactor::kVelocity));
  const Cause cause = CauseOf({curve->candidate}, {0, curve->start});
  EXPECT_EQ(cause.name(), "force_curve");
  EXPECT_EQ(cause.values.size(), force_curve::kFirst + force_curve::kMostKnots);
  EXPECT_EQ(cause.values.head(force_curve::kFirst), curve->candidate.chosen);
  EXPECT_EQ(cause.values.segment(force_curve::kFirst, 5), curve->start);
  EXPECT_TRUE(cause.values.tail(force_curve::kMostKnots - 5).isZero(0.0));
  CheckEffect(stage.machine.plant(), cause);
}

}  // namespace
}  // namespace mjdiag
