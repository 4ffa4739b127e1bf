#pragma once
// Tones beside moves, as large as the limits of the axes allow. The linear machine does the
// sum of what it does with each of them.

#include <vector>

#include "mjdiag/studies/excitation/axis_limits.h"

namespace mjdiag {

class TonesWithinLimits {
 public:
  /// @param moves   a trajectory without its tones
  /// @param limits  of every axis; both must outlive it, as the machine
  TonesWithinLimits(const Machine& machine, const std::vector<AxisLimits>& limits,
                    Trajectory moves);

  /// The moves with these tones, those of an axis all by one factor larger or smaller; an
  /// axis without room for any has none. Peaks of several tones are less than their sum.
  Trajectory With(const std::vector<ReferenceTone>& tones) const;

 private:
  const Machine& machine_;
  const std::vector<AxisLimits>& limits_;
  Trajectory moves_;
  std::vector<AxisCourse> base_;
};

}  // namespace mjdiag
