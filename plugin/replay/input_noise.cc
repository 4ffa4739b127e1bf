#include "mjdiag/plugin/replay/input_noise.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/noise_level.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd Smoothed(const VectorXd& signal, const MeasuredRun& run, double width) {
  if (width <= 0.0) return signal;
  const Index ticks = signal.size() / run.samples();
  width *= static_cast<double>(ticks);
  constexpr double kReach = 3.0;  // standard deviations
  const auto reach = static_cast<Index>(std::ceil(kReach * width));
  const VectorXd window = VectorXd::NullaryExpr(2 * reach + 1, [&](Index i) {
    return std::exp(-0.5 * std::pow(static_cast<double>(i - reach) / width, 2));
  });
  VectorXd smooth(signal.size());
  for (std::size_t record = 0; record < run.records.size(); ++record) {
    const Index first = run.records[record].sample * ticks;
    const Index end = first + run.SamplesOf(record) * ticks;
    for (Index k = first; k < end; ++k) {
      const Index from = std::max(first, k - reach);
      const Index count = std::min(end, k + reach + 1) - from;
      const auto part = window.segment(from - (k - reach), count);
      smooth[k] = part.dot(signal.segment(from, count)) / part.sum();
    }
  }
  return smooth;
}

bool IsNoiseWithin(const VectorXd& signal, const MeasuredRun& run, double width) {
  constexpr double kMost = 5.0;
  if (width <= 0.0) return false;
  const VectorXd taken = signal - Smoothed(signal, run, width);
  const double rms = std::sqrt(taken.squaredNorm() / static_cast<double>(taken.size()));
  return rms > 0.0 && rms <= kMost * NoiseLevel(signal);
}

MeasuredRun WithSmoothedInputs(MeasuredRun run, const VectorXd& widths) {
  const Index ticks = run.ticks();
  for (Index i = 0; i < widths.size(); ++i) {
    if (widths[i] <= 0.0) continue;
    if (ticks == 1) {
      run.inputs.row(i) =
          Smoothed(run.inputs.row(i).transpose(), run, widths[i]).transpose();
      continue;
    }
    const VectorXd fine = Smoothed(run.finer_inputs.row(i).transpose(), run, widths[i]);
    run.finer_inputs.row(i) = fine.transpose();
    run.inputs.row(i) = fine.reshaped(ticks, run.samples()).colwise().mean();
  }
  return run;
}

}  // namespace mjdiag
