#pragma once
// What every tone by itself would tell, as large as an axis may make it.

#include <functional>
#include <vector>

#include "mjdiag/studies/excitation/axis_limits.h"
#include "mjdiag/studies/excitation/motion_information.h"
#include "mjdiag/studies/excitation/tone_shares.h"

namespace mjdiag {

/// In which tones of a motion rise and fall, of its duration.
inline constexpr double kToneRamp = 0.05;

/// Frequencies to try in a motion of that duration, up to the highest [Hz]: evenly in their
/// logarithms, and about the resonances of the plant, where a spring shows most.
std::vector<double> ToneFrequencies(const Machine& machine, double duration,
                                    double highest);

struct ToneTrialOptions {
  double duration = 0.0;           ///< of the whole motion [s]
  double highest_frequency = 0.0;  ///< [Hz]
  std::function<bool()> stop;      ///< from any thread; what is left is not tried
  std::function<void(double fraction)> progress;
};

/// Of every axis, at each of the frequencies.
std::vector<ToneChoice> TryTones(const Machine& machine,
                                 const MotionInformation& information,
                                 const std::vector<AxisLimits>& limits,
                                 const ToneTrialOptions& options);

}  // namespace mjdiag
