#pragma once
// The linear closed loop of a machine: its discrete plant under the feedback of the
// setup's axes.

#include <Eigen/Core>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// Plant and feedback controllers as one autonomous system x[k+1] = A x, at the control
/// rate; x = [plant states; controller states]. Feedforward and saturation do not
/// enter. The loop is stable if all eigenvalues of A lie inside the unit circle.
/// @param plant  discrete, at the control rate, without feedthrough; inputs and outputs
///               are the setup's actuators and sensors in its order (TickModel)
Eigen::MatrixXd ClosedLoopMatrix(const StateSpace& plant, const Setup& setup);

}  // namespace mjdiag
