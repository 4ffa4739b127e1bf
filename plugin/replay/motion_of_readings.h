#pragma once
// Where the readings of a run say that a machine was, and whether that is far from its rest:
// joints that turn by a radian, plants that fall.
//
// The readings y say the configuration: joint positions with g(q) = y, from one moment to
// the next by the step that strains springs least (start_state.h). Positions, velocities
// and accelerations are those of the quadratic polynomial of least squares through the
// readings about a moment (A. Savitzky, M. J. E. Golay, "Smoothing and Differentiation of
// Data by Simplified Least Squares Procedures", Analytical Chemistry 36, 1964).

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/linearize.h"

namespace mjdiag {

struct MeasuredRun;

/// Joint positions, velocities and accelerations of a run at some of its samples, as the
/// readings say. Empty if they do not say it: if no configuration gives the readings.
/// @param samples  in order
std::vector<MotionPoint> MotionOfReadings(const Machine& machine,
                                          const MeasuredRun& run,
                                          const std::vector<Eigen::Index>& samples);

/// Whether an observer of that bandwidth [Hz] may take the machine as what it is at rest.
/// With w = 2 pi bandwidth and differences between rest and 64 moments of the run,
///
///   |dM| < 0.1,   |dK| < w^2 / 2,   |dD| < w / 2       in coordinates of unit mass,
///   |db| < 0.1 of the largest entry:
///
/// what pulls the observer back is more than what the machine does by itself. True if the
/// readings do not say the configuration.
bool RestGainHolds(const Machine& machine, const MeasuredRun& run, double bandwidth);

}  // namespace mjdiag
