#pragma once
// Noise of readings against a motion. What a record shows of a sensor's noise by itself
// (noise_level.h) is that of the sensor. A clock that jitters by dt beside a joint that moves
// at v adds v dt, which is not smooth and no property of the plant either. Behind an observer
// that is as fast as its control allows, innovations hold what is left after a hundredth of a
// second or less: that noise, and little of what the model lacks.

#include <Eigen/Core>
#include <memory>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// Standard deviations [unit of each sensor] of a run along a path, at least `noise_sd`: by
/// the median absolute innovation over the one that noise and the force noise of the
/// observer (observer.h) would leave.
Eigen::VectorXd NoiseInMotion(const Machine& machine, const MeasuredRun& run,
                              const Eigen::VectorXd& noise_sd,
                              const std::shared_ptr<const MotionPath>& path);

/// The fastest bandwidth of an observer [Hz]: 0.15 of the rate of the slowest sensor. Beyond
/// it the observer follows the noise of its sensors.
double FastestBandwidth(const Machine& machine, const MeasuredRun& run);

}  // namespace mjdiag
