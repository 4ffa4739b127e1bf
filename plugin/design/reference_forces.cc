#include "mjdiag/plugin/design/reference_forces.h"

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;

std::array<MatrixXd, 5> ReferenceForcesOf(const MechanicalModel& model,
                                          const Setup& setup) {
  const Index nq = model.M.rows();
  const auto axes = static_cast<Index>(setup.control.axes.size());
  MatrixXd W0 = MatrixXd::Zero(nq + axes, nq + axes);
  MatrixXd start = MatrixXd::Zero(nq + axes, axes);
  W0.topLeftCorner(nq, nq) = model.K;
  for (Index i = 0; i < axes; ++i) {
    const AxisSetup& axis = setup.control.axes[static_cast<std::size_t>(i)];
    W0.col(nq + i).head(nq) =
        -model.Gamma.col(setup.channels.ActuatorIndex(axis.actuator));
    W0.row(nq + i).head(nq) =
        model.b.col(setup.channels.SensorIndex(axis.sensor)).transpose();
    start(nq + i, i) = 1.0;
  }
  std::array<MatrixXd, 5> forces;
  MatrixXd before;
  MatrixXd now = Solve(W0, start);
  for (std::size_t n = 0; n < forces.size(); ++n) {
    if (!now.allFinite()) {
      throw NumericalError("reference forces: the actuators do not move the sensors");
    }
    forces[n] = now.bottomRows(axes);
    MatrixXd right = MatrixXd::Zero(nq + axes, axes);
    right.topRows(nq) = -model.D * now.topRows(nq);
    if (n > 0) right.topRows(nq) -= model.M * before.topRows(nq);
    before = std::move(now);
    now = Solve(W0, right);
  }
  return forces;
}

}  // namespace mjdiag
