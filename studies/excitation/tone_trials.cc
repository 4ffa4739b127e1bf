#include "mjdiag/studies/excitation/tone_trials.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Amplitude and information at the limits of its axis, from a run that is long enough to
/// settle.
void Try(const Machine& machine, const MotionInformation& information,
         const std::vector<AxisLimits>& limits, double duration, ToneChoice& choice) {
  constexpr double kPeriods = 12.0;
  constexpr double kTicks = 2048.0;
  const double tick = machine.rates().tick();
  const AxisSetup& axis = machine.setup().control.axes[choice.axis];
  Trajectory trial;
  trial.name = "tone";
  trial.duration =
      std::min(duration, std::max(kPeriods / choice.frequency, kTicks * tick));
  trial.ramp = 0.25 * trial.duration;
  // Small, and then as large as it may be: all is linear.
  constexpr double kSmall = 1e-6;
  trial.tones = {{axis.name, choice.frequency, kSmall, 0.0}};
  const Excitation motion = FollowTrajectory(machine.setup(), trial);
  const Record run = LinearRun(machine, motion);
  const Index from = run.samples() / 4;
  const Index count = run.samples() / 2;
  double most = 0.0;
  const std::vector<AxisCourse> courses = CoursesOf(machine, motion, run);
  for (std::size_t i = 0; i < courses.size(); ++i) {
    AxisLimits peaks = PeaksOf(courses[i], tick);
    // About the middle of the range.
    AxisLimits own = limits[i];
    own.highest = 0.5 * (limits[i].highest - limits[i].lowest);
    own.lowest = -own.highest;
    // Of other axes only what it asks of their motors.
    if (i != choice.axis) peaks = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, peaks.force};
    most = std::max(most, Utilisation(peaks, own));
  }
  choice.amplitude = kSmall / most;
  const double whole = (1.0 - 2.0 * kToneRamp) * duration / tick;
  choice.information = information.Of(run, from, count) *
                       (whole / static_cast<double>(count) / (most * most));
}

}  // namespace

std::vector<double> ToneFrequencies(const Machine& machine, double duration,
                                    double highest) {
  constexpr int kCount = 36;
  constexpr double kPeriods = 4.0;  // at least, between the ramps
  constexpr double kWeaklyDamped = 0.3;
  const double lowest = kPeriods / duration;
  std::set<double> frequencies;
  for (int i = 0; i < kCount && lowest < highest; ++i) {
    frequencies.insert(lowest * std::pow(highest / lowest, i / (kCount - 1.0)));
  }
  for (const Mode& mode : Modes(machine.linear())) {
    if (!(mode.damping_ratio < kWeaklyDamped)) continue;
    for (const double widths : {-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0}) {
      const double frequency = mode.frequency * (1.0 + widths * mode.damping_ratio);
      if (frequency > lowest && frequency <= highest) frequencies.insert(frequency);
    }
  }
  return {frequencies.begin(), frequencies.end()};
}

std::vector<ToneChoice> TryTones(const Machine& machine,
                                 const MotionInformation& information,
                                 const std::vector<AxisLimits>& limits,
                                 const ToneTrialOptions& options) {
  std::vector<ToneChoice> choices;
  const std::vector<double> frequencies =
      ToneFrequencies(machine, options.duration, options.highest_frequency);
  for (std::size_t axis = 0; axis < limits.size(); ++axis) {
    for (const double frequency : frequencies)
      choices.push_back({axis, frequency, 0.0, {}});
  }
  ParallelFor(
      static_cast<int>(choices.size()),
      [&](int i) {
        if (options.stop && options.stop()) return;
        Try(machine, information, limits, options.duration,
            choices[static_cast<std::size_t>(i)]);
      },
      options.progress);
  // What was stopped before it was tried tells nothing.
  std::erase_if(choices, [](const ToneChoice& choice) {
    return choice.information.size() == 0 || !choice.information.allFinite();
  });
  return choices;
}

}  // namespace mjdiag
