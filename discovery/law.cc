#include "mjdiag/discovery/law.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPoints = 400;
constexpr Index kBins = 40;

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
  return {motion.time, "time", "s"};
}

Eigen::MatrixX2d LawCurve(const Cause& cause, const VectorXd& x,
                          const VectorXd& explained) {
  if (!cause.effect->Law(x.minCoeff(), cause.values)) return BinnedMean(x, explained);
  Eigen::MatrixX2d curve(kPoints, 2);
  curve.col(0) = VectorXd::LinSpaced(kPoints, x.minCoeff(), x.maxCoeff());
  for (Index i = 0; i < kPoints; ++i) {
    curve(i, 1) = cause.effect->Law(curve(i, 0), cause.values).value();
  }
  return curve;
}

}  // namespace mjdiag
