#include "mjdiag/discovery/regression/row_map.h"

namespace mjdiag {

using Eigen::VectorXd;

VectorXd RowMap::Transposed::Along(const Column& column) const {
  VectorXd along = VectorXd::Zero(forces.rows());
  for (const auto& [dof, signal] : column.forces) {
    along += forces.col(dof).cwiseProduct(signal);
  }
  for (const auto& [sensor, signal] : column.readings) {
    along += readings.col(sensor).cwiseProduct(signal);
  }
  return along;
}

double RowMap::Transposed::Times(const Column& column) const {
  double sum = 0.0;
  for (const auto& [dof, signal] : column.forces) sum += forces.col(dof).dot(signal);
  for (const auto& [sensor, signal] : column.readings) {
    sum += readings.col(sensor).dot(signal);
  }
  return sum;
}

}  // namespace mjdiag
