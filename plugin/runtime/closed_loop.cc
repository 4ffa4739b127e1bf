#include "mjdiag/plugin/runtime/closed_loop.h"

#include <algorithm>
#include <vector>

#include "mjdiag/controllers/realisation.h"

namespace mjdiag {
namespace {

StateSpace Feedback(const AxisSetup& axis, double sample_time) {
  const DiscreteCompensator none{{0.0}, {1.0}};
  return Realise(axis.nested ? LinearFeedback(*axis.nested, sample_time)
                             : axis.feedback.value_or(none),
                 sample_time);
}

}  // namespace

Eigen::MatrixXd ClosedLoopMatrix(const StateSpace& plant, const Setup& setup) {
  Eigen::MatrixXd closed = plant.A;
  for (const AxisSetup& axis : setup.control.axes) {
    const StateSpace controller = Feedback(axis, setup.rates.tick());
    const Eigen::Index n = closed.rows();
    const Eigen::Index nc = controller.states();
    // u = drive_gain (C_c x_c - D_c y), y = c x
    const Eigen::VectorXd input =
        axis.drive_gain * plant.B.col(setup.channels.ActuatorIndex(axis.actuator));
    const Eigen::RowVectorXd output =
        plant.C.row(setup.channels.SensorIndex(axis.sensor));
    Eigen::MatrixXd next = Eigen::MatrixXd::Zero(n + nc, n + nc);
    next.topLeftCorner(n, n) = closed;
    next.topLeftCorner(plant.states(), plant.states()) -=
        controller.D(0, 0) * input * output;
    next.block(0, n, plant.states(), nc) = input * controller.C;
    next.block(n, 0, nc, plant.states()) = -controller.B * output;
    next.bottomRightCorner(nc, nc) = controller.A;
    closed = std::move(next);
  }
  return closed;
}

}  // namespace mjdiag
