#include "mjdiag/diagnosis/statistics/thresholds.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kBins = 61;

/// Extremes, fit and histogram of the nominal residuals; limits without margin.
ThresholdDesign Survey(const std::vector<VectorXd>& nominal) {
  Index samples = 0;
  for (const VectorXd& residual : nominal) samples += residual.size();
  if (samples == 0) {
    throw InputError("thresholds", "no nominal residual", "at least one nominal run");
  }
  VectorXd all(samples);
  Index next = 0;
  for (const VectorXd& residual : nominal) {
    all.segment(next, residual.size()) = residual;
    next += residual.size();
  }
  ThresholdDesign design;
  design.limits = {all.minCoeff(), all.maxCoeff()};
  design.fit.mean = all.mean();
  design.fit.sd = std::sqrt((all.array() - design.fit.mean).square().mean());
  const double width = (design.limits.max - design.limits.min) / kBins;
  for (Index i = 0; i <= kBins; ++i) {
    design.histogram.edges.push_back(design.limits.min +
                                     static_cast<double>(i) * width);
  }
  design.histogram.count.assign(kBins, 0);
  for (const double value : all) {
    const double bin = width > 0.0 ? (value - design.limits.min) / width : 0.0;
    ++design.histogram.count[static_cast<std::size_t>(
        std::min(static_cast<Index>(bin), kBins - 1))];
  }
  return design;
}

}  // namespace

ThresholdDesign ThresholdsByMargin(const std::vector<VectorXd>& nominal, double alpha) {
  if (!(alpha >= 1.0)) {
    throw InputError("thresholds", "margin " + std::to_string(alpha), "1 or more");
  }
  ThresholdDesign design = Survey(nominal);
  design.limits.min *= alpha;
  design.limits.max *= alpha;
  design.alpha = alpha;
  return design;
}

ThresholdDesign ThresholdsByFalseAlarms(const std::vector<VectorXd>& nominal,
                                        double probability, double samples) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw InputError("thresholds", "false alarm rate " + std::to_string(probability),
                     "between 0 and 1");
  }
  ThresholdDesign design = Survey(nominal);
  const Interval seen = design.limits;
  const double reach = TwoSidedNormalQuantile(probability / samples) * design.fit.sd;
  design.limits = {design.fit.mean - reach, design.fit.mean + reach};
  design.alpha = std::max(design.limits.max / seen.max, design.limits.min / seen.min);
  return design;
}

}  // namespace mjdiag
