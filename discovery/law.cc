#include "mjdiag/discovery/law.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPoints = 400;
constexpr Index kBins = 40;

double Sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

using Law = std::function<double(const EffectSpec&, double)>;

/// Effects that are functions of one variable.
const std::map<std::string, Law>& Laws() {
  static const std::map<std::string, Law> laws{
      {"coulomb_friction",
       [](const EffectSpec& e, double v) { return -e.Value("force") * Sign(v); }},
      {"stribeck_friction",
       [](const EffectSpec& e, double v) {
         const double ratio = v / e.Value("velocity");
         return -Sign(v) *
                (e.Value("coulomb") + e.Value("breakaway") * std::exp(-ratio * ratio));
       }},
      {"viscous_friction",
       [](const EffectSpec& e, double v) { return -e.Value("coefficient") * v; }},
      {"asymmetric_viscous_friction",
       [](const EffectSpec& e, double v) {
         return -e.Value(v > 0.0 ? "positive" : "negative") * v;
       }},
      {"quadratic_drag",
       [](const EffectSpec& e, double v) {
         return -e.Value("coefficient") * v * std::abs(v);
       }},
      {"force_offset", [](const EffectSpec& e, double) { return e.Value("force"); }},
      {"force_ripple",
       [](const EffectSpec& e, double q) {
         return e.Value("amplitude") *
                std::sin(2.0 * std::numbers::pi * q / e.Value("period") +
                         e.Value("phase"));
       }},
      {"linear_stiffness",
       [](const EffectSpec& e, double q) { return -e.Value("stiffness") * q; }},
      {"cubic_stiffness", [](const EffectSpec& e,
                             double q) { return -e.Value("coefficient") * q * q * q; }},
      {"end_stop",
       [](const EffectSpec& e, double q) {
         const double position = e.Value("position");
         const double beyond = q - position;
         const bool touches = position >= 0.0 ? beyond > 0.0 : beyond < 0.0;
         return touches ? -e.Value("stiffness") * beyond : 0.0;
       }},
      {"added_mass",
       [](const EffectSpec& e, double a) { return -e.Value("mass") * a; }}};
  return laws;
}

Eigen::MatrixX2d BinnedMean(const VectorXd& x, const VectorXd& y) {
  std::vector<Index> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, std::less<>(), [&](Index i) { return x[i]; });
  const Index bins = std::min(kBins, x.size());
  Eigen::MatrixX2d curve = Eigen::MatrixX2d::Zero(bins, 2);
  for (Index b = 0; b < bins; ++b) {
    const Index first = x.size() * b / bins;
    const Index last = x.size() * (b + 1) / bins;
    for (Index i = first; i < last; ++i) {
      const Index k = order[static_cast<std::size_t>(i)];
      curve(b, 0) += x[k] / static_cast<double>(last - first);
      curve(b, 1) += y[k] / static_cast<double>(last - first);
    }
  }
  return curve;
}

}  // namespace

LawVariable VariableOf(const Cause& cause) {
  static const std::map<std::string, LawVariable> variables{
      {"coulomb_friction", LawVariable::kVelocity},
      {"stribeck_friction", LawVariable::kVelocity},
      {"viscous_friction", LawVariable::kVelocity},
      {"asymmetric_viscous_friction", LawVariable::kVelocity},
      {"quadratic_drag", LawVariable::kVelocity},
      {"motor_constant", LawVariable::kInput},
      {"force_saturation", LawVariable::kInput},
      {"input_delay", LawVariable::kInput},
      {"amplifier_lag", LawVariable::kInput},
      {"added_mass", LawVariable::kAcceleration},
      {"flexible_mode", LawVariable::kAcceleration},
      {"force_offset", LawVariable::kTime},
      {"floor_vibration", LawVariable::kTime},
      {"encoder_drift", LawVariable::kTime},
      {"encoder_noise", LawVariable::kTime}};
  const auto found = variables.find(cause.spec.effect);
  if (found != variables.end()) return found->second;
  return cause.fault ? LawVariable::kVelocity : LawVariable::kPosition;
}

LawAxis AxisOf(LawVariable variable, const Candidate& candidate,
               const ObservedMotion& motion, bool hinge,
               const std::string& input_unit) {
  const std::string length = hinge ? "rad" : "m";
  switch (variable) {
    case LawVariable::kPosition:
      return {motion.position.row(candidate.joint), "position", length};
    case LawVariable::kVelocity:
      return {motion.velocity.row(candidate.joint), "velocity", length + "/s"};
    case LawVariable::kAcceleration:
      return {motion.acceleration.row(candidate.joint), "acceleration",
              length + "/s^2"};
    case LawVariable::kInput:
      if (candidate.channel < 0) break;
      return {motion.inputs.row(candidate.channel), "command", input_unit};
    case LawVariable::kTime:
      break;
  }
  const Index n = motion.samples();
  return {VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1) * motion.sample_time),
          "time", "s"};
}

Eigen::MatrixX2d LawCurve(const Cause& cause, const VectorXd& x,
                          const VectorXd& explained) {
  const auto law = Laws().find(cause.spec.effect);
  if (cause.fault || law == Laws().end()) return BinnedMean(x, explained);
  Eigen::MatrixX2d curve(kPoints, 2);
  curve.col(0) = VectorXd::LinSpaced(kPoints, x.minCoeff(), x.maxCoeff());
  for (Index i = 0; i < kPoints; ++i) {
    curve(i, 1) = law->second(cause.spec, curve(i, 0));
  }
  return curve;
}

}  // namespace mjdiag
