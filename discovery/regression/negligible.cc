#include "mjdiag/discovery/regression/negligible.h"

#include <cmath>

#include "mjdiag/discovery/regression/disturbance_map.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of rows.
VectorXd Rms(const MatrixXd& signals) {
  return signals.rowwise().norm() / std::sqrt(static_cast<double>(signals.cols()));
}

}  // namespace

Negligible::Negligible(const Machine& machine, const FilterPath& path,
                       const VectorXd& reading_sd,
                       const std::vector<ScaledColumn>& known, const Column* steps)
    : machine_(machine), path_(path), reading_sd_(reading_sd) {
  constexpr double kOfKnown = 0.01;
  constexpr double kOfSteps = 0.1;
  least_ = kOfKnown * ForcesOf(known);
  if (steps != nullptr) least_ += kOfSteps * ForcesOf({{1.0, steps}});
}

VectorXd Negligible::ForcesOf(const std::vector<ScaledColumn>& columns) const {
  const MatrixXd& M = machine_.mechanics().M;
  const Index nv = M.rows();
  MatrixXd changes = MatrixXd::Zero(nv, path_.samples());
  MatrixXd forces = MatrixXd::Zero(nv, path_.samples());
  for (const auto& [amplitude, column] : columns) {
    for (const auto& [state, signal] : column->states) {
      if (state < nv || state >= 2 * nv) continue;
      changes.row(state - nv) += amplitude * signal.transpose();
    }
    for (const auto& [dof, signal] : column->forces) {
      forces.row(dof) += amplitude * signal.transpose();
    }
  }
  return Rms(forces + M * changes / path_.sample_time);
}

bool Negligible::IsForce(const std::vector<ScaledColumn>& columns) const {
  return (ForcesOf(columns).array() <= least_.array()).all();
}

bool Negligible::IsError(const std::vector<ScaledColumn>& columns) const {
  // Five standard deviations tell a feature of one reading from its noise (A. Rose, "Vision:
  // Human and Electronic", 1973).
  constexpr double kSeen = 5.0;
  MatrixXd errors = MatrixXd::Zero(path_.sensors(), path_.samples());
  for (const auto& [amplitude, column] : columns) {
    for (const auto& [sensor, signal] : column->readings) {
      errors.row(sensor) += amplitude * signal.transpose();
    }
  }
  const VectorXd largest = errors.cwiseAbs().rowwise().maxCoeff();
  if ((largest.array() > kSeen * reading_sd_.array()).any()) return false;
  const MechanicalModel& mechanics = machine_.mechanics();
  const MatrixXd q = PositionOfReadings(path_) * errors;
  const double h = path_.sample_time;
  MatrixXd forces = MatrixXd::Zero(q.rows(), q.cols());
  for (std::size_t record = 0; record < path_.first.size(); ++record) {
    for (Index k = path_.first[record] + 1; k + 1 < path_.EndOf(record); ++k) {
      const VectorXd v = (q.col(k + 1) - q.col(k - 1)) / (2.0 * h);
      const VectorXd a = (q.col(k + 1) - 2.0 * q.col(k) + q.col(k - 1)) / (h * h);
      forces.col(k) = mechanics.M * a + mechanics.D * v + mechanics.K * q.col(k);
    }
  }
  // Where a force may be: readings of several joints tell nothing of each.
  const VectorXd at_latent = Rms(forces)(path_.dofs);
  return (at_latent.array() <= least_(path_.dofs).array()).all();
}

}  // namespace mjdiag
