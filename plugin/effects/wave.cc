#include "mjdiag/plugin/effects/wave.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

CandidateRegressor WaveRegressor(const VectorXd& entry, const VectorXd& angle,
                                 double value) {
  CandidateRegressor trial;
  trial.signals.resize(angle.size(), 2);
  trial.signals << angle.array().sin(), angle.array().cos();
  if (entry.size() > 0) trial.entry = entry.replicate(1, 2);
  trial.values = [value](const Amplitudes& a) -> RegressorValues {
    const auto [amplitude, phase] = AmplitudeAndPhase(a[0], a[1]);
    return ValuesOf({amplitude, value, phase});
  };
  return trial;
}

namespace {

// What does not come round once is no wave.
constexpr Index kCoarsest = 4;

/// Quarters of a period over the stroke, as many as a motion tells apart that goes through
/// a period in no less than four samples half of the time that it moves.
Index FinestOf(const VectorXd& x) {
  constexpr Index kMostQuarters = 40000;
  std::vector<double> moves;
  for (Index k = 1; k < x.size(); ++k) {
    const double move = std::abs(x[k] - x[k - 1]);
    if (move > 1e-9 * Range(x)) moves.push_back(move);
  }
  if (moves.empty()) return kCoarsest;
  std::ranges::nth_element(moves, moves.begin() + std::ssize(moves) / 2);
  const double finest = Range(x) / moves[moves.size() / 2];
  return std::clamp(static_cast<Index>(finest), kCoarsest, kMostQuarters);
}

}  // namespace

ParameterScan PeriodScan(const VectorXd& entry, const VectorXd& x, int finest,
                         int step) {
  const double range = Range(x);
  ParameterScan sweep;
  for (Index m = kCoarsest; m <= finest; m += step) {
    sweep.values.push_back(4.0 * range / static_cast<double>(m));
  }
  sweep.count = (FinestOf(x) - kCoarsest) / step + 1;
  sweep.value = [range, step](Index i) {
    return 4.0 * range / static_cast<double>(kCoarsest + i * step);
  };
  sweep.angle = kCoarsest * kTurn / (4.0 * range) * x;
  sweep.increment = step * kTurn / (4.0 * range) * x;
  sweep.make = [entry, x](double period) {
    return WaveRegressor(entry, kTurn / period * x, period);
  };
  return sweep;
}

ParameterScan FrequencyScan(const VectorXd& entry, const ObservedMotion& motion,
                            double duration) {
  // A quarter of the sampling rate: what acts between samples is the same but for a tenth.
  const double highest = std::min(0.25 / motion.sample_time, 250.0);
  const double spacing = 0.7 / duration;
  ParameterScan sweep;
  for (double f = 2.0 * spacing; f < highest; f += spacing) sweep.values.push_back(f);
  sweep.count = std::ssize(sweep.values);
  sweep.value = [spacing](Index i) { return static_cast<double>(2 + i) * spacing; };
  const VectorXd& time = motion.time;
  sweep.angle = kTurn * 2.0 * spacing * time;
  sweep.increment = kTurn * spacing * time;
  sweep.make = [entry, time](double frequency) {
    return WaveRegressor(entry, kTurn * frequency * time, frequency);
  };
  return sweep;
}

std::pair<double, double> AmplitudeAndPhase(double a, double b) {
  return {std::hypot(a, b), std::atan2(b, a)};
}

}  // namespace mjdiag
