#pragma once
// How far, fast and hard the axes of a machine go.

#include <array>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// Where one axis is, and its largest magnitudes, in SI units of it (m or rad).
struct AxisLimits {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  double lowest = -kNone;  ///< position, of the reference and of the reading [m]
  double highest = kNone;
  double velocity = kNone;  ///< of the reference, like those that follow [m/s]
  double acceleration = kNone;
  double jerk = kNone;   ///< between two samples
  double snap = kNone;   ///< held from one sample to the next
  double force = kNone;  ///< of the actuator, as it is commanded [N or N m]
};

/// All of them, by name.
inline constexpr std::array<std::pair<const char*, double AxisLimits::*>, 7>
    kAxisLimits{{{"lowest", &AxisLimits::lowest},
                 {"highest", &AxisLimits::highest},
                 {"velocity", &AxisLimits::velocity},
                 {"acceleration", &AxisLimits::acceleration},
                 {"jerk", &AxisLimits::jerk},
                 {"snap", &AxisLimits::snap},
                 {"force", &AxisLimits::force}}};

/// The one of that name; null if there is none.
inline double* FindLimit(AxisLimits& limits, std::string_view name) {
  for (const auto& [known, limit] : kAxisLimits) {
    if (name == known) return &(limits.*limit);
  }
  return nullptr;
}

/// What an axis does, sample by sample: a linear machine does the sum of what it does.
struct AxisCourse {
  Eigen::VectorXd position;
  Eigen::VectorXd velocity;
  Eigen::VectorXd acceleration;
  Eigen::VectorXd snap;
  Eigen::VectorXd reading;
  Eigen::VectorXd force;

  AxisCourse& AddTimes(double factor, const AxisCourse& other);
};

/// Of every axis of the setup, in a run of that motion.
std::vector<AxisCourse> CoursesOf(const Machine& machine, const Excitation& motion,
                                  const Record& run);
AxisLimits PeaksOf(const AxisCourse& course, double tick);

/// The largest of peak / limit, of positions from the middle of their range; above 1:
/// beyond a limit.
double Utilisation(const AxisLimits& peaks, const AxisLimits& limits);

/// That of every axis.
std::vector<double> Utilisations(const std::vector<AxisCourse>& courses,
                                 const std::vector<AxisLimits>& limits, double tick);

}  // namespace mjdiag
