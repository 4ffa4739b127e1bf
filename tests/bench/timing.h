#pragma once
// What the benchmarks measure with.

#include <Eigen/Core>
#include <chrono>
#include <vector>

#include "mjdiag/signals/median.h"
#include "mjdiag/signals/processor_time.h"

namespace mjdiag {

/// On the clock [s].
inline double ClockTime() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// What an action takes by a time of these: ClockTime, ThreadTime, ProcessTime.
template <typename Action>
double Seconds(double (*time)(), const Action& action) {
  const double start = time();
  action();
  return time() - start;
}

inline double Median(const std::vector<double>& values) {
  return Median(Eigen::VectorXd(
      Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()))));
}

}  // namespace mjdiag
