#pragma once
// Noise of inputs that were measured. A torque that is read from a current has noise as any
// reading has, and none that the machine felt; taken as it is, it makes every motor look
// weak (attenuation: W. A. Fuller, Measurement Error Models, Wiley 1987, 1.1). What the
// machine felt is what was measured, smoothed over so many ticks as its motion tells.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Behind a Gaussian window of that standard deviation [ticks], which does not delay; each
/// record by itself. 0: as it is.
Eigen::VectorXd Smoothed(const Eigen::VectorXd& signal, const MeasuredRun& run,
                         double width);

/// @param widths  of every actuator [ticks]
MeasuredRun WithSmoothedInputs(MeasuredRun run, const Eigen::VectorXd& widths);

}  // namespace mjdiag
