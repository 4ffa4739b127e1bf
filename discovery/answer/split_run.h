#pragma once
// What of measurements fits see, and what they do not: records of their own, else the end of
// every one that is fitted, for each may show what no other one does. A filter comes to that
// end from the beginning: begun anew in the midst of a motion it would tell where it began
// from what is to be judged.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct SplitRun {
  MeasuredRun seen;
  /// Records that they do not see, or the whole of those of which they see the beginnings.
  MeasuredRun unseen;
  /// How many samples at the beginning of each of its records they see: all 0, or none 0.
  std::vector<Eigen::Index> seen_of;
  double share = 1.0;  ///< of the records for fits that these see

  /// Whether `unseen` goes on from where `seen` ends.
  bool GoesOn() const { return seen_of.front() > 0; }
  /// Which samples of `unseen` they do not see.
  SampleMask New() const;
};

/// The same looked at once in some ticks (coarser_run.h).
SplitRun Coarser(const SplitRun& run, int ticks);

/// @param train_share  of every record, where there are none that nothing is fitted to
SplitRun Split(const Measurements& measurements, double train_share);

}  // namespace mjdiag
