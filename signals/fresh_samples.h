#pragma once
// A sensor or a bus that is slower than the record, or stops for a while, repeats its
// last value: which samples of a reading are new ones?
//
// A machine that rests and a coarse encoder repeat values, too. What tells them apart, by
// the steps q of the reading (its resolution, or the smallest step that it takes at values
// of that size, or from one value that repeats to the next that does: encoders behind
// filters have values in between):
//
//   beat    values change at every n-th sample and at no others, by 3 q and more: a
//           sensor of 1 / n of the rate, moving or not
//   motion  before and after the repeats the reading moves the same way at every change,
//           so fast that it would have gone 3 q on meanwhile, and then it has gone that
//           way: what had rested would not
//   jump    5 equal values or more, then a step of 3 q and more that is 3 times every
//           step around, of a reading that moves that way
//
// By chance a noisy reading of steps takes no step half as often as it takes one up or
// down; repeats that are no more frequent than such single steps are of that kind.

#include <Eigen/Core>

#include "mjdiag/signals/record.h"

namespace mjdiag {

/// How coarse a reading is.
struct ReadingScale {
  double resolution = 0.0;  ///< [unit]; 0: as its values show
  double noise_sd = 0.0;    ///< [unit]; 0: not known
};

struct FreshSamples {
  SampleMask fresh;         ///< empty: all
  Eigen::Index period = 1;  ///< samples, of a sensor that has a beat
};

/// @param times    [s], increasing, one a sample
/// @param reading  finite
FreshSamples FindFreshSamples(const Eigen::VectorXd& times,
                              const Eigen::VectorXd& reading,
                              const ReadingScale& scale);

}  // namespace mjdiag
