#pragma once
// The part of dry friction that goes away with speed [Stribeck 1902]:
//   exp(-(v / velocity)^2)

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/effects/candidate_regressor.h"

namespace mjdiag {

double StribeckShare(double v, double velocity) noexcept;

/// CandidateRegressors of friction with a constant part and one that goes away with speed.
/// @param slide  what the constant part makes of a bound of 1, samples
std::vector<CandidateRegressor> StribeckRegressors(const SiteMotion& at,
                                                   const Eigen::VectorXd& slide);

}  // namespace mjdiag
