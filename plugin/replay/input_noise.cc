#include "mjdiag/plugin/replay/input_noise.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd Smoothed(const VectorXd& signal, const MeasuredRun& run, double width) {
  if (width <= 0.0) return signal;
  constexpr double kReach = 3.0;  // standard deviations
  const auto reach = static_cast<Index>(std::ceil(kReach * width));
  const VectorXd window = VectorXd::NullaryExpr(2 * reach + 1, [&](Index i) {
    return std::exp(-0.5 * std::pow(static_cast<double>(i - reach) / width, 2));
  });
  VectorXd smooth(signal.size());
  for (std::size_t record = 0; record < run.records.size(); ++record) {
    const Index first = run.records[record].sample;
    const Index end = first + run.SamplesOf(record);
    for (Index k = first; k < end; ++k) {
      const Index from = std::max(first, k - reach);
      const Index count = std::min(end, k + reach + 1) - from;
      const auto part = window.segment(from - (k - reach), count);
      smooth[k] = part.dot(signal.segment(from, count)) / part.sum();
    }
  }
  return smooth;
}

MeasuredRun WithSmoothedInputs(MeasuredRun run, const VectorXd& widths) {
  for (Index i = 0; i < widths.size(); ++i) {
    if (widths[i] <= 0.0) continue;
    run.inputs.row(i) =
        Smoothed(run.inputs.row(i).transpose(), run, widths[i]).transpose();
  }
  return run;
}

}  // namespace mjdiag
