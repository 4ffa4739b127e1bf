#include "mjdiag/studies/excitation/axis_limits.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {
namespace {

double Peak(const Eigen::VectorXd& values) {
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

}  // namespace

AxisCourse& AxisCourse::AddTimes(double factor, const AxisCourse& other) {
  position += factor * other.position;
  velocity += factor * other.velocity;
  acceleration += factor * other.acceleration;
  snap += factor * other.snap;
  reading += factor * other.reading;
  force += factor * other.force;
  return *this;
}

std::vector<AxisCourse> CoursesOf(const Machine& machine, const Excitation& motion,
                                  const Record& run) {
  std::vector<AxisCourse> courses;
  const std::vector<AxisSetup>& axes = machine.setup().control.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AxisReference& reference = motion.reference.axes[i];
    courses.push_back({reference.position, reference.velocity, reference.acceleration,
                       reference.snap, run.At(axes[i].sensor).samples,
                       run.At(axes[i].actuator).samples});
  }
  return courses;
}

AxisLimits PeaksOf(const AxisCourse& course, double tick) {
  const Eigen::Index steps = std::max<Eigen::Index>(course.acceleration.size() - 1, 0);
  const Eigen::VectorXd jerk =
      (course.acceleration.tail(steps) - course.acceleration.head(steps)) / tick;
  return {.lowest = std::min(course.position.minCoeff(), course.reading.minCoeff()),
          .highest = std::max(course.position.maxCoeff(), course.reading.maxCoeff()),
          .velocity = Peak(course.velocity),
          .acceleration = Peak(course.acceleration),
          .jerk = Peak(jerk),
          .snap = Peak(course.snap),
          .force = Peak(course.force)};
}

double Utilisation(const AxisLimits& peaks, const AxisLimits& limits) {
  double most = 0.0;
  const auto use = [&](double peak, double limit) {
    if (peak > 0.0) most = std::max(most, peak / limit);
  };
  if (std::isfinite(limits.lowest) && std::isfinite(limits.highest)) {
    const double middle = 0.5 * (limits.lowest + limits.highest);
    use(std::max(peaks.highest - middle, middle - peaks.lowest),
        0.5 * (limits.highest - limits.lowest));
  }
  use(peaks.velocity, limits.velocity);
  use(peaks.acceleration, limits.acceleration);
  use(peaks.jerk, limits.jerk);
  use(peaks.snap, limits.snap);
  use(peaks.force, limits.force);
  return most;
}

std::vector<double> Utilisations(const std::vector<AxisCourse>& courses,
                                 const std::vector<AxisLimits>& limits, double tick) {
  std::vector<double> used;
  for (std::size_t i = 0; i < courses.size(); ++i) {
    used.push_back(Utilisation(PeaksOf(courses[i], tick), limits[i]));
  }
  return used;
}

}  // namespace mjdiag
