#include "mjdiag/signals/state_space.h"

#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

std::string Shape(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

void RequireShape(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                  Eigen::Index columns) {
  if (matrix.rows() == rows && matrix.cols() == columns) return;
  throw InputError("state space",
                   std::string(name) + " is " + Shape(matrix.rows(), matrix.cols()),
                   Shape(rows, columns));
}

}  // namespace

void RequireShapes(const StateSpace& system) {
  RequireShape("A", system.A, system.states(), system.states());
  RequireShape("B", system.B, system.states(), system.inputs());
  RequireShape("C", system.C, system.outputs(), system.states());
  RequireShape("D", system.D, system.outputs(), system.inputs());
}

}  // namespace mjdiag
