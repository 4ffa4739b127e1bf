#include "mjdiag/diagnosis/model/delta_form.h"

#include <Eigen/Cholesky>

#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;

StateSpace DeltaForm(const MechanicalModel& model, const TickTiming& timing) {
  StateSpace tick = TickModel(model, timing.step, timing.substeps);
  const Index nq = model.M.rows();
  const MatrixXd root = Eigen::LLT<MatrixXd>(model.M).matrixU();
  const MatrixXd inverse =
      root.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(nq, nq));
  MatrixXd to = MatrixXd::Zero(2 * nq, 2 * nq);
  to.topLeftCorner(nq, nq) = root;
  to.bottomRightCorner(nq, nq) = timing.tick() * root;
  MatrixXd from = MatrixXd::Zero(2 * nq, 2 * nq);
  from.topLeftCorner(nq, nq) = inverse;
  from.bottomRightCorner(nq, nq) = inverse / timing.tick();

  const MatrixXd change = tick.A - MatrixXd::Identity(2 * nq, 2 * nq);
  tick.A = to * change * from / kDeltaScale;
  tick.B = (to * tick.B / kDeltaScale).eval();
  tick.C = (tick.C * from).eval();
  return tick;
}

SignalEntry HeldForces(const MechanicalModel& model, const TickTiming& timing,
                       const MatrixXd& forces) {
  if (forces.rows() != model.M.rows()) {
    throw InputError(
        "forces", std::to_string(forces.rows()) + " rows",
        "one for each of the " + std::to_string(model.M.rows()) + " coordinates");
  }
  MechanicalModel driven = model;
  driven.Gamma = forces;
  const StateSpace system = DeltaForm(driven, timing);
  return {system.B, system.D};
}

}  // namespace mjdiag
