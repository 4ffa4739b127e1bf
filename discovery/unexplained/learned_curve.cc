#include "mjdiag/discovery/unexplained/learned_curve.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/wave.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the largest speed: below, a joint has no direction (as Direction has it).
constexpr double kStillShare = 1.0 / 200.0;

const MotionVariable* Find(const std::vector<MotionVariable>& variables,
                           const std::string& name) {
  const auto found = std::ranges::find(variables, name, &MotionVariable::name);
  return found == variables.end() ? nullptr : &*found;
}

/// @param own  whether it is the velocity of the joint itself, where friction turns round
CurveAxis AxisOver(const VectorXd& x, double period, bool own, double still,
                   int knots) {
  if (period > 0.0) return {0.0, period, CurveShapes::kPeriodic, knots};
  const double low = x.minCoeff();
  const double high = x.maxCoeff();
  if (own && low < 0.0 && high > 0.0) {
    return {low, high, CurveShapes::kSplit, 2 * ((knots + 1) / 2), still};
  }
  return {low, high, CurveShapes::kPlain, knots};
}

/// How the force answers to every knot, samples x knots.
MatrixXd Design(const CurveAxis& axis, const VectorXd& x, const VectorXd& factor) {
  MatrixXd design = MatrixXd::Zero(x.size(), axis.knots);
  for (Index k = 0; k < x.size(); ++k) {
    const CurveAxis::Weights weights = axis.At(x[k]);
    for (std::size_t i = 0; i < weights.place.size(); ++i) {
      design(k, weights.place[i]) += weights.weight[i] * factor[k];
    }
  }
  return design;
}

}  // namespace

std::optional<FittedCause> WaveOf(const std::vector<Candidate>& candidates,
                                  const UnknownSignal& force,
                                  const Signature& signature,
                                  const std::vector<MotionVariable>& variables,
                                  const ObservedMotion& motion, Index joint) {
  const MotionVariable* over = Find(variables, signature.variable);
  if (over == nullptr || signature.period <= 0.0 || !signature.factor.empty()) {
    return std::nullopt;
  }
  const bool own = over->kind == CurveVariable::kPosition && over->of == joint;
  if (!own && over->kind != CurveVariable::kTime) return std::nullopt;
  const Effect& wave = own ? ForceRipple() : FloorVibration();
  const auto candidate = std::ranges::find_if(candidates, [&](const Candidate& one) {
    return one.effect.get() == &wave && one.site == force.site;
  });
  if (candidate == candidates.end()) return std::nullopt;
  const Eigen::ArrayXd angle =
      kTurn / signature.period * (own ? over->value : motion.time).array();
  MatrixXd design(angle.size(), 3);
  design << angle.sin().matrix(), angle.cos().matrix(), VectorXd::Ones(angle.size());
  const VectorXd parts = LeastSquares(design, force.value);
  const auto [amplitude, phase] = AmplitudeAndPhase(parts[0], parts[1]);
  const double shape = own ? signature.period : 1.0 / signature.period;
  return Bounded(candidates, {static_cast<std::size_t>(candidate - candidates.begin()),
                              Eigen::Vector3d(amplitude, shape, phase)});
}

std::optional<LearnedCurve> LearnCurve(const UnknownSignal& force,
                                       const Signature& signature,
                                       const std::vector<MotionVariable>& variables,
                                       const ObservedMotion& motion, Index joint,
                                       double spread, int knots) {
  const MotionVariable* over = Find(variables, signature.variable);
  const MotionVariable* times = Find(variables, signature.factor);
  const CurveFactor factor = times == nullptr ? CurveFactor::kNone : times->factor;
  // A step between two directions is a split curve over the velocity.
  if (over != nullptr && over->factor == CurveFactor::kDirection) {
    for (const MotionVariable& variable : variables) {
      const bool is_velocity = variable.kind == CurveVariable::kVelocity;
      if (is_velocity && variable.of == joint) over = &variable;
    }
  }
  if (over == nullptr || !over->kind) return std::nullopt;
  const VectorXd x = *over->kind == CurveVariable::kTime ? motion.time : over->value;
  const double fastest = motion.velocity.row(joint).cwiseAbs().maxCoeff();
  const double still = kStillShare * fastest;
  const bool own = *over->kind == CurveVariable::kVelocity && over->of == joint;
  const CurveAxis axis = AxisOver(x, signature.period, own, still, knots);
  if (!(axis.high > axis.low)) return std::nullopt;
  const VectorXd m = motion.velocity.row(joint).transpose().unaryExpr(
      [&](double v) { return FactorOf(factor, v, still); });
  const MatrixXd design = Design(axis, x, m);

  LearnedCurve learned;
  learned.candidate = {.effect = Lasting(ForceCurve()),
                       .site = force.site,
                       .joint = joint,
                       .parameters = {}};
  VectorXd& chosen = learned.candidate.chosen;
  chosen = VectorXd::Zero(force_curve::kFirst);
  chosen[force_curve::kVariable] = static_cast<double>(*over->kind);
  chosen[force_curve::kOf] = over->of;
  chosen[force_curve::kFactor] = static_cast<double>(factor);
  chosen[force_curve::kStill] = still;
  chosen[force_curve::kLow] = axis.low;
  chosen[force_curve::kWidth] = axis.high - axis.low;
  chosen[force_curve::kShape] = static_cast<double>(axis.shape);
  chosen[force_curve::kKnots] = axis.knots;
  const double unit = factor == CurveFactor::kVelocity && fastest > 0.0 ? fastest : 1.0;
  const auto& parameters = ForceCurve().parameters();
  for (int i = 0; i < axis.knots; ++i) {
    const EffectParameter& p =
        parameters[static_cast<std::size_t>(force_curve::kFirst + i)];
    learned.candidate.parameters.push_back(
        {p.name, p.role, p.minimum, p.maximum, 0.0, spread / unit});
  }
  // Knots that nothing comes near are nothing.
  learned.start = LeastNorm(design, force.value);
  learned.over = over->name;
  learned.unit = over->unit;
  learned.x = x;
  if (axis.shape == CurveShapes::kPeriodic) {
    learned.x -= axis.high * (x / axis.high).array().floor().matrix();
  }
  return learned;
}

}  // namespace mjdiag
