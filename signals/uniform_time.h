#pragma once
// From a column of times to a sample time: times in files are rounded decimals or
// floats, records have one sample time.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

namespace mjdiag {

/// t_k = start + k * sample_time
struct UniformTime {
  double start = 0.0;        ///< [s], the first time
  double sample_time = 0.0;  ///< [s], > 0
};

/// The uniform grid that the times lie on. Among the sample times that agree with the
/// first and last time within rounding, the simplest decimal period or rate is taken:
/// 24841 times 0, 0.001, ... give exactly 0.001 s, and a record's own times give its
/// sample time back, bitwise if it is such a number.
/// @param times  [s], one a sample
/// @param place  where sample k stands, for messages
/// InputError: fewer than two samples, a time that is not after the one before it, or a
/// time more than 1 % of a sample off the grid; it names the place and both intervals.
UniformTime FitUniformTime(const Eigen::VectorXd& times,
                           const std::function<std::string(Eigen::Index)>& place);

/// The same, or none if a time is off the grid.
std::optional<UniformTime> FindUniformTime(
    const Eigen::VectorXd& times,
    const std::function<std::string(Eigen::Index)>& place);

}  // namespace mjdiag
