#include "mjdiag/diagnosis/model/left_null_space.h"

#include <cmath>

#include "mjdiag/diagnosis/model/equilibrate.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Singular values below this part of the largest, after equilibration, are zero.
constexpr double kNullTolerance = 1e-11;

int RankOf(const VectorXd& singular_values) {
  return static_cast<int>(
      (singular_values.array() > kNullTolerance * singular_values[0]).count());
}

int Rank(const MatrixXd& matrix) {
  return RankOf(SingularValuesOf(Equilibrate(matrix).matrix));
}

/// [C A^i | for every k: what N_x,k B_d + N_y,k D_d takes from N_y,i], i = 0 .. degree:
/// the observability stack beside the block Toeplitz matrix of the unknown inputs.
MatrixXd Equations(const StateSpace& system, const SignalEntry& unknown, int degree) {
  const Index ny = system.outputs();
  const Index nx = system.states();
  const Index nd = unknown.B.cols();
  const MatrixXd stack = ObservabilityStack(system, degree);
  MatrixXd equations = MatrixXd::Zero(stack.rows(), nx + (degree + 1) * nd);
  equations.leftCols(nx) = stack;
  for (Index k = 0; k <= degree && nd > 0; ++k) {
    const Index column = nx + k * nd;
    equations.block(k * ny, column, ny, nd) = unknown.D;
    const Index below = degree - k;
    equations.block((k + 1) * ny, column, below * ny, nd) =
        stack.topRows(below * ny) * unknown.B;
  }
  return equations;
}

/// The one row vector p with p * equations = right_side.
RowVectorXd SolveUnique(const MatrixXd& equations, const RowVectorXd& right_side) {
  const Equilibrated scaled = Equilibrate(equations);
  const SingularValues svd = SingularValueDecomposition(scaled.matrix.transpose());
  const VectorXd& values = svd.values;
  if (equations.rows() > equations.cols() ||
      values[values.size() - 1] <= kNullTolerance * values[0]) {
    throw NumericalError("the pins leave more than one parity relation");
  }
  const VectorXd target = scaled.columns.asDiagonal() * right_side.transpose();
  const VectorXd parts =
      (svd.U.transpose() * target).head(values.size()).cwiseQuotient(values);
  const VectorXd solution = svd.V * parts;
  const double residual = (scaled.matrix.transpose() * solution - target).norm();
  if (residual > 1e-8 * target.norm()) {
    throw NumericalError("no parity relation has the pinned coefficients");
  }
  return (scaled.rows.asDiagonal() * solution).transpose();
}

/// N_y as one row vector [N_y,0 .. N_y,degree] that annihilates the stack.
RowVectorXd SolveOutputPart(const MatrixXd& stack, Index outputs,
                            const std::vector<PinnedCoefficient>& pins) {
  RowVectorXd row = RowVectorXd::Zero(stack.rows());
  std::vector<bool> pinned(static_cast<std::size_t>(stack.rows()), false);
  for (const PinnedCoefficient& pin : pins) {
    const Index index = pin.power * outputs + pin.output;
    row[index] = pin.value;
    pinned[static_cast<std::size_t>(index)] = true;
  }
  std::vector<Index> free;
  for (Index i = 0; i < stack.rows(); ++i) {
    if (!pinned[static_cast<std::size_t>(i)]) free.push_back(i);
  }
  row(free) = SolveUnique(stack(free, Eigen::all), -row * stack);
  return row;
}

}  // namespace

MatrixXd ObservabilityStack(const StateSpace& system, int degree) {
  const Index ny = system.outputs();
  MatrixXd stack((degree + 1) * ny, system.states());
  MatrixXd block = system.C;
  for (int i = 0; i <= degree; ++i) {
    stack.middleRows(i * ny, ny) = block;
    block = block * system.A;
  }
  return stack;
}

std::vector<int> ObservabilityRanks(const StateSpace& system, int max_degree) {
  const MatrixXd stack = ObservabilityStack(system, max_degree);
  std::vector<int> ranks;
  for (int degree = 0; degree <= max_degree; ++degree) {
    ranks.push_back(Rank(stack.topRows((degree + 1) * system.outputs())));
  }
  return ranks;
}

NullSpace LeftNullSpace(const StateSpace& system, const SignalEntry& unknown_inputs,
                        int degree) {
  if (degree < 0) {
    throw InputError("residual", "degree " + std::to_string(degree), "0 or more");
  }
  const Equilibrated scaled = Equilibrate(Equations(system, unknown_inputs, degree));
  const SingularValues svd = SingularValueDecomposition(scaled.matrix);
  const VectorXd& values = svd.values;
  const int rank = RankOf(values);
  const MatrixXd basis = svd.U.rightCols(scaled.matrix.rows() - rank);
  return {degree, basis.transpose() * scaled.rows.asDiagonal(),
          values[rank - 1] / values[0]};
}

NullSpace LeftNullSpace(const StateSpace& system, int degree) {
  return LeftNullSpace(system, NoSignal(system), degree);
}

int MinimalDegree(const StateSpace& system, const SignalEntry& unknown_inputs,
                  int max_degree) {
  std::string found;
  for (int degree = 0; degree <= max_degree; ++degree) {
    const MatrixXd equations = Equations(system, unknown_inputs, degree);
    const int rank = Rank(equations);
    if (rank < equations.rows()) return degree;
    found += (degree > 0 ? ", " : "") + std::to_string(rank) + " of " +
             std::to_string(equations.rows());
  }
  throw InputError("residual",
                   "no parity relation of degree " + std::to_string(max_degree) +
                       " or less is blind to nominal motion (ranks " + found + ")",
                   "a higher degree, more sensors or fewer unknown inputs");
}

PolynomialMatrix CompleteRelations(const StateSpace& system,
                                   const MatrixXd& output_part) {
  const Index nx = system.states();
  const Index ny = system.outputs();
  const Index degree = output_part.cols() / ny - 1;
  PolynomialMatrix relations;
  relations.coefficients.assign(static_cast<std::size_t>(degree + 1),
                                MatrixXd::Zero(output_part.rows(), nx + ny));
  MatrixXd states = MatrixXd::Zero(output_part.rows(), nx);
  for (Index k = degree; k >= 0; --k) {
    MatrixXd& coefficient = relations.coefficients[static_cast<std::size_t>(k)];
    const auto outputs = output_part.middleCols(k * ny, ny);
    coefficient.leftCols(nx) = states;
    coefficient.rightCols(ny) = outputs;
    states = (states * system.A + outputs * system.C).eval();
  }
  return relations;
}

PolynomialMatrix LeftNullVector(const StateSpace& system, int degree,
                                const std::vector<PinnedCoefficient>& pins) {
  return CompleteRelations(system, SolveOutputPart(ObservabilityStack(system, degree),
                                                   system.outputs(), pins));
}

ParityRelation PinnedParityRelation(const MechanicalModel& model, int degree,
                                    const std::vector<PinnedCoefficient>& pins) {
  const double time_unit = FastTimeUnit(model);
  const StateSpace system = UnitMassStateSpace(model, time_unit);
  // The coefficient of s^k is time_unit^k times that of the scaled operator; L has -I
  // in front of y.
  std::vector<PinnedCoefficient> scaled_pins = pins;
  for (PinnedCoefficient& pin : scaled_pins) {
    pin.value *= -std::pow(time_unit, -pin.power);
  }
  const PolynomialMatrix residual =
      LeftNullVector(system, degree, scaled_pins) * MakeDae(system).L;
  ParityRelation relation{MatrixXd(system.outputs(), degree + 1),
                          MatrixXd(system.inputs(), degree + 1)};
  for (int k = 0; k <= degree; ++k) {
    const RowVectorXd coefficient =
        std::pow(time_unit, k) * residual.coefficients[static_cast<std::size_t>(k)];
    relation.outputs.col(k) = coefficient.head(system.outputs()).transpose();
    relation.inputs.col(k) = coefficient.tail(system.inputs()).transpose();
  }
  return relation;
}

}  // namespace mjdiag
