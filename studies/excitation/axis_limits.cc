#include "mjdiag/studies/excitation/axis_limits.h"

#include <algorithm>

namespace mjdiag {
namespace {

double Peak(const Eigen::VectorXd& values) {
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

}  // namespace

std::vector<std::pair<const char*, double>> Named(const AxisLimits& limits) {
  return {{"position", limits.position},
          {"velocity", limits.velocity},
          {"acceleration", limits.acceleration},
          {"jerk", limits.jerk},
          {"snap", limits.snap},
          {"force", limits.force}};
}

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
  return {.position = std::max(Peak(course.position), Peak(course.reading)),
          .velocity = Peak(course.velocity),
          .acceleration = Peak(course.acceleration),
          .jerk = Peak(jerk),
          .snap = Peak(course.snap),
          .force = Peak(course.force)};
}

double Utilisation(const AxisLimits& peaks, const AxisLimits& limits) {
  const auto values = Named(peaks);
  const auto bounds = Named(limits);
  double most = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].second > 0.0)
      most = std::max(most, values[i].second / bounds[i].second);
  }
  return most;
}

}  // namespace mjdiag
