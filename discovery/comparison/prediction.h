#pragma once
// How far ahead a model predicts a machine: with the measured inputs alone the plant runs on
// from where the filter that follows the measured motion (force_filter.h) has it, which
// knows the readings up to then, and without the forces that the filter adds. What it then
// reads after a horizon of h ticks, less what was measured, is the error of a prediction over
// h. Effects with a memory begin every prediction without it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct Prediction {
  std::vector<double> horizons;  ///< [s]
  struct Sensor {
    std::string channel;
    std::string unit;
    Eigen::VectorXd rms;  ///< of every horizon; infinite where one diverges
  };
  std::vector<Sensor> sensors;
};

/// Over one tick, 10 ms, 100 ms and 1 s, as far as those are longer than a tick and no more
/// than a quarter of the shortest record; from 200 moments of the run at most, and no more
/// than make ten times its length.
/// @param skip  samples at the start of every record that count for nothing
Prediction Predict(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, Eigen::Index skip);
/// @param skip  the same of every record
Prediction Predict(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, const std::vector<Eigen::Index>& skip);

}  // namespace mjdiag
