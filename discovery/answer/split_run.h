#pragma once
// What of measurements fits see, and what they do not: records of their own, else the end of
// the one that is fitted, which goes on in motion.

#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct SplitRun {
  MeasuredRun seen;
  MeasuredRun unseen;
  double share = 1.0;  ///< of the records for fits that these see
};

/// @param measurements  of one plant, WithUnseen
/// @param train_share   of a single record
/// InputError on records with a plant of their own: latent forces are those of one plant.
SplitRun Split(const Measurements& measurements, double train_share);

}  // namespace mjdiag
