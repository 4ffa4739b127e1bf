#include "mjdiag/diagnosis/model/mechanical_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::LLT<MatrixXd> FactorMass(const MatrixXd& mass) {
  Eigen::LLT<MatrixXd> factor(mass);
  if (factor.info() != Eigen::Success) {
    throw NumericalError("the mass matrix is not positive definite");
  }
  return factor;
}

/// L^-1 X L^-T for M = L L^T: the matrix in coordinates of unit mass, in which stiff
/// and soft, translational and rotational joints are comparable.
MatrixXd InUnitMass(const Eigen::LLT<MatrixXd>& mass, const MatrixXd& matrix) {
  const MatrixXd left = mass.matrixL().solve(matrix);
  return mass.matrixL().solve(left.transpose()).transpose();
}

/// One Euler step of length `step`, with the output at its start.
StateSpace EulerStep(const MechanicalModel& model, double step) {
  const Index nq = model.M.rows();
  const MatrixXd implicit_mass = model.M + step * model.D;
  const MatrixXd from_q = -step * Solve(implicit_mass, model.K);
  const MatrixXd from_v =
      MatrixXd::Identity(nq, nq) - step * Solve(implicit_mass, model.D);
  const MatrixXd from_u = step * Solve(implicit_mass, model.Gamma);
  StateSpace result;
  result.A.resize(2 * nq, 2 * nq);
  result.A << MatrixXd::Identity(nq, nq) + step * from_q, step * from_v, from_q, from_v;
  result.B.resize(2 * nq, model.Gamma.cols());
  result.B << step * from_u, from_u;
  result.C = MatrixXd::Zero(model.b.cols(), 2 * nq);
  result.C.leftCols(nq) = model.b.transpose();
  result.D = MatrixXd::Zero(model.b.cols(), model.Gamma.cols());
  result.sample_time = step;
  return result;
}

}  // namespace

std::vector<Mode> Modes(const MechanicalModel& model) {
  if (model.M.rows() == 0) return {};
  const Index nq = model.M.rows();
  const double time_unit = FastTimeUnit(model);
  const EigenPairs eigen = EigenDecomposition(UnitMassStateSpace(model, time_unit).A);
  const MatrixXd to_joints =
      FactorMass(model.M).matrixU().solve(MatrixXd::Identity(nq, nq));
  // An undamped rigid body has a double pole at zero, which rounding splits to the
  // square root of the machine precision.
  constexpr double kRigid = 1e-7;
  std::vector<Mode> modes;
  for (Index i = 0; i < 2 * nq; ++i) {
    const std::complex<double> pole = eigen.values[i];
    if (std::abs(pole) < kRigid || pole.imag() < 0.0) continue;
    const VectorXd shape =
        (to_joints.cast<std::complex<double>>() * eigen.vectors.col(i).head(nq))
            .cwiseAbs();
    modes.push_back({std::abs(pole) / (2.0 * std::numbers::pi * time_unit),
                     (0.0 - pole.real()) / std::abs(pole), shape / shape.maxCoeff()});
  }
  std::sort(modes.begin(), modes.end(),
            [](const Mode& a, const Mode& b) { return a.frequency < b.frequency; });
  return modes;
}

StateSpace UnitMassStateSpace(const MechanicalModel& model, double time_unit) {
  const Index nq = model.M.rows();
  const Eigen::LLT<MatrixXd> mass = FactorMass(model.M);
  StateSpace result;
  result.A = MatrixXd::Zero(2 * nq, 2 * nq);
  result.A.topRightCorner(nq, nq).setIdentity();
  result.A.bottomLeftCorner(nq, nq) =
      -time_unit * time_unit * InUnitMass(mass, model.K);
  result.A.bottomRightCorner(nq, nq) = -time_unit * InUnitMass(mass, model.D);
  result.B = MatrixXd::Zero(2 * nq, model.Gamma.cols());
  result.B.bottomRows(nq) = time_unit * time_unit * mass.matrixL().solve(model.Gamma);
  result.C = MatrixXd::Zero(model.b.cols(), 2 * nq);
  result.C.leftCols(nq) = mass.matrixL().solve(model.b).transpose();
  result.D = MatrixXd::Zero(model.b.cols(), model.Gamma.cols());
  return result;
}

double FastTimeUnit(const MechanicalModel& model) {
  const Eigen::LLT<MatrixXd> mass = FactorMass(model.M);
  const double rate = std::max(std::sqrt(InUnitMass(mass, model.K).norm()),
                               InUnitMass(mass, model.D).norm());
  return rate > 0.0 ? 1.0 / rate : 1.0;
}

StateSpace ContinuousStateSpace(const MechanicalModel& model) {
  const Index nq = model.M.rows();
  const Eigen::LLT<MatrixXd> mass = FactorMass(model.M);
  StateSpace result;
  result.A = MatrixXd::Zero(2 * nq, 2 * nq);
  result.A.topRightCorner(nq, nq).setIdentity();
  result.A.bottomLeftCorner(nq, nq) = -mass.solve(model.K);
  result.A.bottomRightCorner(nq, nq) = -mass.solve(model.D);
  result.B = MatrixXd::Zero(2 * nq, model.Gamma.cols());
  result.B.bottomRows(nq) = mass.solve(model.Gamma);
  result.C = MatrixXd::Zero(model.b.cols(), 2 * nq);
  result.C.leftCols(nq) = model.b.transpose();
  result.D = MatrixXd::Zero(model.b.cols(), model.Gamma.cols());
  return result;
}

StateSpace TickModel(const MechanicalModel& model, double step, int substeps) {
  FactorMass(model.M);
  const StateSpace substep = EulerStep(model, step);
  StateSpace tick = substep;
  for (int i = 1; i < substeps; ++i) {
    tick.A = substep.A * tick.A;
    tick.B = substep.A * tick.B + substep.B;
  }
  tick.sample_time = step * substeps;
  return tick;
}

}  // namespace mjdiag
