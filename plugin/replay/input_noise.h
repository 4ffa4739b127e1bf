#pragma once
// Noise of inputs that were measured. A torque that is read from a current has noise as any
// reading has, and none that the machine felt; taken as it is, it makes every motor look
// weak (attenuation: W. A. Fuller, Measurement Error Models, Wiley 1987, 1.1). What the
// machine felt is what was measured, smoothed over so many ticks as its motion tells.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Behind a Gaussian window of that standard deviation [samples of the run], which does not
/// delay; each record by itself. 0: as it is.
/// @param signal  of every sample of the run, or of every tick of these
Eigen::VectorXd Smoothed(const Eigen::VectorXd& signal, const MeasuredRun& run,
                         double width);

/// Whether what smoothing takes from a signal is noise: about as much as differences of
/// neighbouring samples say (noise_level.h), up to five times for noise that lasts some
/// samples. Edges and curvature of a command that has none are no noise: taking them away
/// hides that a drive follows late.
bool IsNoiseWithin(const Eigen::VectorXd& signal, const MeasuredRun& run, double width);

/// @param widths  of every actuator [samples of the run]
MeasuredRun WithSmoothedInputs(MeasuredRun run, const Eigen::VectorXd& widths);

}  // namespace mjdiag
