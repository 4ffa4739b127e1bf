#include "mjdiag/studies/excitation/tones_within_limits.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/design/filter_design.h"

namespace mjdiag {
namespace {

std::vector<AxisCourse> LinearCourses(const Machine& machine,
                                      const Trajectory& trajectory) {
  const Excitation motion = FollowTrajectory(machine.setup(), trajectory);
  return CoursesOf(machine, motion, LinearRun(machine, motion));
}

}  // namespace

TonesWithinLimits::TonesWithinLimits(const Machine& machine,
                                     const std::vector<AxisLimits>& limits,
                                     Trajectory moves)
    : machine_(machine), limits_(limits), moves_(std::move(moves)) {
  moves_.tones.clear();
  base_ = LinearCourses(machine_, moves_);
}

Trajectory TonesWithinLimits::With(const std::vector<ReferenceTone>& tones) const {
  constexpr int kRounds = 3;  // the motors of other axes answer a little
  constexpr int kHalvings = 20;
  constexpr double kMost = 8.0;
  // The nonlinear machine is not quite the linear one.
  constexpr double kMargin = 0.998;
  // Where it begins may be the end of its range, and a tone that begins there the other
  // way round is little at first.
  constexpr double kLittle = 1e-3;
  const std::vector<AxisSetup>& axes = machine_.setup().control.axes;
  std::vector<std::vector<AxisCourse>> courses;
  for (const AxisSetup& axis : axes) {
    Trajectory own = moves_;
    own.moves.clear();
    std::ranges::copy_if(
        tones, std::back_inserter(own.tones),
        [&](const ReferenceTone& tone) { return tone.axis == axis.name; });
    courses.push_back(LinearCourses(machine_, own));
  }
  std::vector<double> factors(axes.size(), 1.0);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      AxisCourse others = base_[axis];
      for (std::size_t i = 0; i < axes.size(); ++i) {
        if (i != axis) others.AddTimes(factors[i], courses[i][axis]);
      }
      const auto use = [&](const AxisCourse& course) {
        return Utilisation(PeaksOf(course, machine_.rates().tick()), limits_[axis]);
      };
      const double allowed = std::max(kMargin, std::min(1.0, use(others) + kLittle));
      const auto fits = [&](double factor) {
        AxisCourse all = others;
        all.AddTimes(factor, courses[axis][axis]);
        return use(all) <= allowed;
      };
      double low = 0.0;
      double high = kMost;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (fits(middle) ? low : high) = middle;
      }
      factors[axis] = low;
    }
  }
  Trajectory trajectory = moves_;
  for (ReferenceTone tone : tones) {
    const auto axis = std::ranges::find(axes, tone.axis, &AxisSetup::name);
    tone.amplitude *= factors[static_cast<std::size_t>(axis - axes.begin())];
    if (tone.amplitude != 0.0) trajectory.tones.push_back(tone);
  }
  return trajectory;
}

}  // namespace mjdiag
