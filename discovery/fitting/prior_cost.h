#pragma once
// What is known of parameters beforehand, as measurements of them: of every parameter with
// a spread s its distance from nothing n,
//
//   sqrt(w) (theta - n) / s,      w the weight of what is known beside innovations

#include <ceres/cost_function.h>

#include <vector>

#include "mjdiag/discovery/fitting/fit_coordinates.h"

namespace mjdiag {

class PriorCost final : public ceres::CostFunction {
 public:
  /// @param coordinates  in which the parameters are varied; not owned
  PriorCost(const std::vector<FitParameter>& parameters,
            const FitCoordinates& coordinates, double weight);
  bool Evaluate(const double* const* blocks, double* residuals,
                double** jacobians) const override;

 private:
  struct Known {
    int place;
    double nothing;
    double slope;
  };
  const FitCoordinates& coordinates_;
  std::vector<Known> known_;
};

}  // namespace mjdiag
