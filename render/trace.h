#pragma once
// What the clip plots over time, for every run: the tracking errors of the axes.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/render/record_sampling.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// One quantity, for each run that is drawn.
struct Trace {
  std::string name;                   ///< short, for the readout, for example "x error"
  std::string caption;                ///< for the chart, without unit
  std::string unit;                   ///< SI
  std::vector<Eigen::VectorXd> runs;  ///< samples of each run, in the runs' order
};

/// The value of a trace's run at a time [s]; `record` is that run.
double TraceValue(const Trace& trace, std::size_t run, const Record& record,
                  double time);

/// Axes that a record can show the tracking error of: every "a" with an "a_ref".
std::vector<std::string> TrackedAxes(const Record& record);

/// Tracking errors "a_ref" - "a". InputError names a channel that a run lacks.
std::vector<Trace> TrackingErrors(std::span<const Record* const> runs,
                                  const std::vector<std::string>& axes);

/// Smallest and largest value of all runs inside the range, and zero.
struct ValueRange {
  double low = 0.0;
  double high = 0.0;
};
ValueRange RangeWithZero(const Trace& trace, std::span<const Record* const> runs,
                         TimeRange range);

}  // namespace mjdiag
