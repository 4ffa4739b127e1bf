#pragma once
// The white noise of sensors as a record shows it.

#include <Eigen/Core>

#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Standard deviation of the noise of every sensor by itself [unit]: what its readings have
/// that no smooth motion makes (noise_level.h), at least that of its quantisation and above
/// rounding.
Eigen::VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run);

}  // namespace mjdiag
