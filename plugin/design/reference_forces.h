#pragma once
// The forces that a linear machine needs to follow a reference, along its derivatives:
// the expansion in s, about rest, of the inverse of its transfer function from the
// commands to the readings of its axes. With
//
//   W0 = [K, -Gamma; b^T, 0],  W1 = [D, 0; 0, 0],  W2 = [M, 0; 0, 0]
//   W0 X0 = [0; I],  W0 X1 = -W1 X0,  W0 Xn = -W1 X(n-1) - W2 X(n-2)
//
// the lower rows of Xn are the commands to a unit of the n-th derivative. It is what
// feedforward of velocity, acceleration and snap approximates for one axis ([AB383],
// Eq. 35), here for all of them, with what the one asks of the other.

#include <array>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

/// Commands of the axes' actuators to a unit of the derivatives 0 to 4 of the reference
/// of each axis, axes x axes. NumericalError if the actuators cannot move the readings.
std::array<Eigen::MatrixXd, 5> ReferenceForcesOf(const MechanicalModel& model,
                                                 const Setup& setup);

}  // namespace mjdiag
