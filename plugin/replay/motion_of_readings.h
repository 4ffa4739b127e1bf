#pragma once
// Where the readings of a run say that a machine was.
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

}  // namespace mjdiag
