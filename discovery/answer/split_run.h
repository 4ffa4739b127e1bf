#pragma once
// What of measurements fits see, and what they do not: records of their own, else the end of
// the one that is fitted. A filter comes to that end from the beginning: begun anew in the
// midst of a motion it would tell where it began from what is to be judged.

#include <Eigen/Core>

#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct SplitRun {
  MeasuredRun seen;
  /// Records that they do not see, or the whole of the one of which they see the beginning.
  MeasuredRun unseen;
  /// Sample of it at which that begins which they do not see.
  Eigen::Index first_unseen = 0;
  double share = 1.0;  ///< of the records for fits that these see
};

/// @param measurements  of one plant, WithUnseen
/// @param train_share   of a single record
/// InputError on records with a plant of their own: latent forces are those of one plant.
SplitRun Split(const Measurements& measurements, double train_share);

}  // namespace mjdiag
