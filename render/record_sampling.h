#pragma once
// Records looked at in time instead of sample by sample.

#include <Eigen/Core>

#include "mjdiag/signals/record.h"

namespace mjdiag {

/// From time `begin` to `end` [s].
struct TimeRange {
  double begin = 0.0;
  double end = 0.0;
};

/// Samples first .. last of a record, both included.
struct SampleRange {
  Eigen::Index first = 0;
  Eigen::Index last = 0;
  Eigen::Index count() const { return last - first + 1; }
};

/// The samples that lie inside the range; at least one.
SampleRange SamplesWithin(const Record& record, TimeRange range);

/// The value at a time [s], linear between samples and held at the ends. `samples` is
/// a signal on the record's time grid.
double SampleAt(const Record& record, const Eigen::VectorXd& samples, double time);

}  // namespace mjdiag
