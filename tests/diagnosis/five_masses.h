#pragma once
// Five masses in a row, whose springs differ by four orders of magnitude.

#include <Eigen/Core>

#include "mjdiag/diagnosis/model/mechanical_model.h"

namespace mjdiag::test {

inline constexpr Eigen::Index kMasses = 5;

/// M, D and K of masses between 50 g and 7 kg and springs from 0.1 to 1000 N/mm, the
/// first of them to the ground. Forces and outputs are for the test to add.
inline MechanicalModel FiveMasses() {
  using Vector = Eigen::Vector<double, kMasses>;
  const Eigen::VectorXd mass = (Vector() << 2.0, 0.4, 7.0, 1.0, 0.05).finished();
  const Eigen::VectorXd spring = (Vector() << 1e2, 1e4, 1e6, 3e5, 2e3).finished();
  MechanicalModel model;
  model.M = mass.asDiagonal();
  model.K = Eigen::MatrixXd::Zero(kMasses, kMasses);
  for (Eigen::Index i = 0; i < kMasses; ++i) {
    model.K(i, i) += spring[i];
    if (i == 0) continue;
    model.K(i - 1, i - 1) += spring[i];
    model.K(i, i - 1) = model.K(i - 1, i) = -spring[i];
  }
  model.D = 1e-4 * model.K + 0.1 * model.M;
  return model;
}

}  // namespace mjdiag::test
