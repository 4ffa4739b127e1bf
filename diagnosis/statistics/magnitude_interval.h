#pragma once
// The confidence interval of a magnitude whose parts are estimated: of tones with unknown
// phases, gamma^2 = s^2 + c^2 of each. With estimates of s and c of variance v, the sum of
// their squares over v is a noncentral chi-squared variable of noncentrality
// gamma^2 / v and as many degrees of freedom as there are parts, also where gamma is not
// large against its error and nothing is normal about it.

#include <Eigen/Core>

#include "mjdiag/diagnosis/statistics/interval.h"

namespace mjdiag {

/// Of an estimate with normal errors. @param outside  probability, above 0, below 1
Interval NormalInterval(double estimate, double sd, double outside);

/// From the largest magnitude that would be exceeded with half of `outside` to the smallest
/// that would stay below with the other half. The lower end is 0 where no magnitude would do
/// so. Where less was seen than noise alone leaves on average, the interval is that of the
/// average: it is never empty, and does not become short by luck (G. Cowan et al.,
/// arXiv:1105.3166).
/// @param magnitude  what noise leaves on average removed, not below 0 (TwinEstimator)
/// @param sd         of each part, which is that of a large magnitude
/// @param parts      2 a tone, 1 or more
/// @param outside    probability, above 0, below 1
Interval MagnitudeInterval(double magnitude, double sd, Eigen::Index parts,
                           double outside);

}  // namespace mjdiag
