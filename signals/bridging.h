#pragma once
// A channel that was not measured at every sample, on the grid of its record: what was
// measured where, and numbers for the rest.
//
// A sample of the grid counts as measured
//   on the times of the file    where the file has one
//   on a grid of its own        where it lies between two of the file that are no farther
//                               apart than 2.5 usual intervals (one is missing), or on one;
//                               of a channel slower than the grid only the nearest one to
//                               every sample of the file
// The others go straight from the one before to the next one, but for switches: of a
// command, too, that is the better guess than that it waited.

#include <Eigen/Core>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/resampling.h"

namespace mjdiag {

/// From this many usual intervals on, time between samples is a gap.
inline constexpr double kGap = 2.5;

struct Bridged {
  Eigen::VectorXd samples;
  SampleMask measured;  ///< empty: all of them
};

/// Bitwise Resample, or the samples themselves, where nothing is missing.
/// @param times  [s], one a sample, increasing
/// @param valid  which samples are; empty: all; two at least
Bridged Bridge(const Eigen::VectorXd& times, const Eigen::VectorXd& samples,
               const SampleMask& valid, const SampleGrid& grid, Course course);

/// Time in gaps between those times.
struct Gaps {
  Eigen::Index count = 0;
  double first = 0.0;    ///< when the first one begins [s]
  double longest = 0.0;  ///< [s]
  double total = 0.0;    ///< [s]
};
Gaps FindGaps(const Eigen::VectorXd& times);
/// Samples of a uniform record that lie in gaps between those that were measured.
SampleMask InGaps(const SampleMask& measured);

}  // namespace mjdiag
