#include "mjdiag/plugin/design/parity_facts.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/diagnosis/residuals/parity_programs.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Orthonormal columns that span those of `matrix`.
MatrixXd ColumnSpace(const MatrixXd& matrix) {
  // Above the rounding of differences of linearised models.
  constexpr double kNonzero = 1e-6;
  const SingularValues svd = SingularValueDecomposition(matrix);
  const VectorXd& values = svd.values;
  const Index rank = (values.array() > kNonzero * values[0]).count();
  return svd.U.leftCols(values[0] > 0.0 ? rank : 0);
}

/// Generalised forces that a changed fault parameter makes, whatever the motion:
/// damping, stiffness and motor forces change by dD q', dK q and dGamma u. Each change
/// is taken relative to its matrix and in coordinates of unit mass, so that a change of
/// one matrix is not confused with the rounding of another.
MatrixXd ForcesOf(const PerturbedModels& fault, const MechanicalModel& healthy) {
  const Eigen::LLT<MatrixXd> mass(healthy.M);
  const Index n = healthy.M.rows();
  const auto relative = [&](const MatrixXd& change, const MatrixXd& whole) {
    const double size = mass.matrixL().solve(whole).norm();
    return MatrixXd(mass.matrixL().solve(change) / (size > 0.0 ? size : 1.0));
  };
  // Columns act on motion in coordinates of unit mass, too.
  const auto square = [&](const MatrixXd& change, const MatrixXd& whole) {
    const auto columns = [&](const MatrixXd& matrix) {
      return MatrixXd(mass.matrixL().solve(matrix.transpose()).transpose());
    };
    return relative(columns(change), columns(whole));
  };
  MatrixXd changes(n, 2 * n + healthy.Gamma.cols());
  changes << square(fault.plus.D - fault.minus.D, healthy.D),
      square(fault.plus.K - fault.minus.K, healthy.K),
      relative(fault.plus.Gamma - fault.minus.Gamma, healthy.Gamma);
  return mass.matrixL() * ColumnSpace(changes);
}

SignalEntry FaultEntry(const Machine& machine, const MechanicalModel& healthy,
                       const TickTiming& timing) {
  const std::vector<PerturbedModels> faults = MakeFaultFamily(machine).Perturbed();
  if (faults.empty()) {
    throw InputError("method lp", "the plant has no fault parameters",
                     "at least one, for a parity relation has to see a fault");
  }
  MatrixXd forces(healthy.M.rows(), 0);
  for (const PerturbedModels& fault : faults) {
    const MatrixXd more = ForcesOf(fault, healthy);
    MatrixXd all(forces.rows(), forces.cols() + more.cols());
    all << forces, more;
    forces = all;
  }
  SignalEntry entry = HeldForces(healthy, timing, forces);
  for (Index j = 0; j < entry.B.cols(); ++j) {
    const double size = std::hypot(entry.B.col(j).norm(), entry.D.col(j).norm());
    entry.B.col(j) /= size;
    entry.D.col(j) /= size;
  }
  return entry;
}

/// [N_y,0 .. N_y,degree] of a relation N = [N_x, N_y].
VectorXd OutputPart(const PolynomialMatrix& relation, Index outputs) {
  VectorXd part(outputs * (relation.degree() + 1));
  for (int k = 0; k <= relation.degree(); ++k) {
    part.segment(k * outputs, outputs) =
        relation.coefficients[static_cast<std::size_t>(k)].row(0).tail(outputs);
  }
  return part;
}

/// Between a vector and the span of the rows of a matrix [rad].
double Angle(const VectorXd& vector, const MatrixXd& rows) {
  const MatrixXd basis = ColumnSpace(rows.transpose());
  const VectorXd inside = basis * (basis.transpose() * vector);
  return std::atan2((vector - inside).norm(), inside.norm());
}

}  // namespace

SignalEntry UnknownForceEntry(const MechanicalModel& healthy,
                              const SynthesisOptions& options) {
  const MatrixXd& forces = options.unknown_inputs.forces;
  if (forces.cols() == 0) return NoSignal(DeltaForm(healthy, options.timing));
  return HeldForces(healthy, options.timing, forces);
}

ParityProgramFacts SolveParityPrograms(const Machine& machine,
                                       const MechanicalModel& healthy) {
  const SynthesisOptions options = SynthesisOf(machine);
  const StateSpace system = DeltaForm(healthy, options.timing);
  const SignalEntry unknown = UnknownForceEntry(healthy, options);
  const SignalEntry faults = FaultEntry(machine, healthy, options.timing);
  const DaeModel dae = MakeDae(system, unknown, faults);
  ParityProgramFacts facts;
  facts.degree = options.residual.degree;
  facts.norm = "one";
  facts.fault_inputs = static_cast<int>(dae.F.cols());
  const std::optional<ParityProgramSolution> solution = SolveParityPrograms(
      dae, options.residual.degree, ParityProgramOptions{RelationNorm::kOne});
  facts.programs = facts.fault_inputs * (dae.F.degree() + options.residual.degree + 1);
  if (!solution) return facts;
  facts.programs = solution->programs;
  facts.feasible = solution->feasible;
  facts.objective = solution->objective;
  facts.defect = solution->defect;
  const NullSpace null_space = LeftNullSpace(system, unknown, options.residual.degree);
  facts.angle = Angle(OutputPart(solution->N, system.outputs()), null_space.relations);
  return facts;
}

}  // namespace mjdiag
