#include "mjdiag/plugin/effects/wave.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/trial_signals.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

Trial WaveTrial(const VectorXd& entry, const VectorXd& angle, double value) {
  Trial trial;
  trial.signals.resize(angle.size(), 2);
  trial.signals << angle.array().sin(), angle.array().cos();
  if (entry.size() > 0) trial.entry = entry.replicate(1, 2);
  trial.values = [value](const Amplitudes& a) -> TrialValues {
    const auto [amplitude, phase] = AmplitudeAndPhase(a[0], a[1]);
    return ValuesOf({amplitude, value, phase});
  };
  return trial;
}

Sweep PeriodSweep(const VectorXd& entry, const VectorXd& x, int finest, int step) {
  const double range = Range(x);
  Sweep sweep;
  // What does not come round once is no wave.
  constexpr int kCoarsest = 4;
  for (int m = kCoarsest; m <= finest; m += step) {
    sweep.values.push_back(4.0 * range / m);
  }
  sweep.angle = kCoarsest * kTurn / (4.0 * range) * x;
  sweep.increment = step * kTurn / (4.0 * range) * x;
  sweep.make = [entry, x](double period) {
    return WaveTrial(entry, kTurn / period * x, period);
  };
  return sweep;
}

Sweep FrequencySweep(const VectorXd& entry, const ObservedMotion& motion,
                     double duration) {
  // A quarter of the sampling rate: what acts between samples is the same but for a tenth.
  const double highest = std::min(0.25 / motion.sample_time, 250.0);
  const double spacing = 0.7 / duration;
  Sweep sweep;
  for (double f = 2.0 * spacing; f < highest; f += spacing) sweep.values.push_back(f);
  const VectorXd& time = motion.time;
  sweep.angle = kTurn * 2.0 * spacing * time;
  sweep.increment = kTurn * spacing * time;
  sweep.make = [entry, time](double frequency) {
    return WaveTrial(entry, kTurn * frequency * time, frequency);
  };
  return sweep;
}

std::pair<double, double> AmplitudeAndPhase(double a, double b) {
  return {std::hypot(a, b), std::atan2(b, a)};
}

}  // namespace mjdiag
