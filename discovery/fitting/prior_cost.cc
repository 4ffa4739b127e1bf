#include "mjdiag/discovery/fitting/prior_cost.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {

using Eigen::VectorXd;

PriorCost::PriorCost(const std::vector<FitParameter>& parameters,
                     const FitCoordinates& coordinates, double weight)
    : coordinates_(coordinates) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!std::isfinite(parameters[i].spread)) continue;
    known_.push_back({static_cast<int>(i), parameters[i].nothing,
                      std::sqrt(weight) / parameters[i].spread});
  }
  set_num_residuals(static_cast<int>(known_.size()));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters.size()));
}

bool PriorCost::Evaluate(const double* const* blocks, double* residuals,
                         double** jacobians) const {
  const int size = parameter_block_sizes()[0];
  const VectorXd theta =
      coordinates_.ToTheta(Eigen::Map<const VectorXd>(blocks[0], size));
  const VectorXd along = coordinates_.SlopeAt(theta);
  double* J = jacobians == nullptr ? nullptr : jacobians[0];
  if (J != nullptr) std::fill_n(J, num_residuals() * size, 0.0);
  for (std::size_t row = 0; row < known_.size(); ++row) {
    const auto& [place, nothing, slope] = known_[row];
    residuals[row] = slope * (theta[place] - nothing);
    if (J != nullptr) J[static_cast<int>(row) * size + place] = slope * along[place];
  }
  return true;
}

}  // namespace mjdiag
