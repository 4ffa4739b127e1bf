#pragma once
// What a record of the disturbance residual has to be, whatever is estimated from it.

#include <Eigen/Core>

namespace mjdiag {

/// Samples of the shortest record, and of the shortest segment of one.
inline constexpr Eigen::Index kMinSegment = 64;

/// InputError unless the sample time is positive, the record has so many samples or
/// more, and all are finite.
void RequireRecord(const Eigen::VectorXd& residual, double sample_time,
                   Eigen::Index samples);

}  // namespace mjdiag
