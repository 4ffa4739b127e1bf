#include "mjdiag/diagnosis/left_null_space.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Singular values below this part of the largest, after equilibration, are zero.
constexpr double kRankTolerance = 1e-11;

/// diag(rows) * original * diag(columns), with rows and columns of comparable norm.
struct Equilibrated {
  MatrixXd matrix;
  VectorXd rows;
  VectorXd columns;
};

double InverseRootNorm(double norm) { return norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0; }

Equilibrated Equilibrate(const MatrixXd& matrix) {
  Equilibrated result{matrix, VectorXd::Ones(matrix.rows()),
                      VectorXd::Ones(matrix.cols())};
  // Each sweep takes the square root of what is left of the imbalance.
  constexpr int kSweeps = 12;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const VectorXd rows = result.matrix.rowwise().norm().unaryExpr(&InverseRootNorm);
    const VectorXd columns =
        result.matrix.colwise().norm().transpose().unaryExpr(&InverseRootNorm);
    result.matrix = rows.asDiagonal() * result.matrix * columns.asDiagonal();
    result.rows.array() *= rows.array();
    result.columns.array() *= columns.array();
  }
  return result;
}

int Rank(const MatrixXd& matrix) {
  const Eigen::JacobiSVD<MatrixXd> svd(Equilibrate(matrix).matrix);
  const VectorXd& values = svd.singularValues();
  return static_cast<int>((values.array() > kRankTolerance * values[0]).count());
}

/// The one row p with p * equations = right_side.
RowVectorXd SolveUnique(const MatrixXd& equations, const RowVectorXd& right_side) {
  const Equilibrated scaled = Equilibrate(equations);
  const Eigen::JacobiSVD<MatrixXd> svd(scaled.matrix.transpose(),
                                       Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& values = svd.singularValues();
  if (equations.rows() > equations.cols() ||
      values[values.size() - 1] <= kRankTolerance * values[0]) {
    throw NumericalError("the pins leave more than one residual row");
  }
  const VectorXd target = scaled.columns.asDiagonal() * right_side.transpose();
  const VectorXd solution = svd.solve(target);
  const double misfit = (scaled.matrix.transpose() * solution - target).norm();
  if (misfit > 1e-8 * target.norm()) {
    throw NumericalError("no residual row has the pinned coefficients");
  }
  return (scaled.rows.asDiagonal() * solution).transpose();
}

/// N_y as one row [N_y,0 .. N_y,degree] that annihilates the stack.
RowVectorXd SolveOutputPart(const MatrixXd& stack, Index outputs,
                            const std::vector<RowPin>& pins) {
  RowVectorXd row = RowVectorXd::Zero(stack.rows());
  std::vector<bool> pinned(static_cast<std::size_t>(stack.rows()), false);
  for (const RowPin& pin : pins) {
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

PolynomialMatrix LeftNullRow(const StateSpace& system, int degree,
                             const std::vector<RowPin>& pins) {
  const Index nx = system.states();
  const Index ny = system.outputs();
  const RowVectorXd outputs =
      SolveOutputPart(ObservabilityStack(system, degree), ny, pins);
  PolynomialMatrix row;
  row.coefficients.assign(static_cast<std::size_t>(degree + 1),
                          MatrixXd::Zero(1, nx + ny));
  // Synthetic division: N_x,k-1 = N_x,k A + N_y,k C.
  RowVectorXd states = RowVectorXd::Zero(nx);
  for (int k = degree; k >= 0; --k) {
    MatrixXd& coefficient = row.coefficients[static_cast<std::size_t>(k)];
    coefficient.leftCols(nx) = states;
    coefficient.rightCols(ny) = outputs.segment(k * ny, ny);
    states = states * system.A + outputs.segment(k * ny, ny) * system.C;
  }
  return row;
}

ResidualRow PinnedResidualRow(const MechanicalModel& model, int degree,
                              const std::vector<RowPin>& pins) {
  const double time_unit = FastTimeUnit(model);
  const StateSpace system = UnitMassStateSpace(model, time_unit);
  // The coefficient of s^k is time_unit^k times that of the scaled operator; L has -I
  // in front of y.
  std::vector<RowPin> scaled_pins = pins;
  for (RowPin& pin : scaled_pins) {
    pin.value *= -std::pow(time_unit, -pin.power);
  }
  const PolynomialMatrix residual =
      LeftNullRow(system, degree, scaled_pins) * MakeDae(system).L;
  ResidualRow row{MatrixXd(system.outputs(), degree + 1),
                  MatrixXd(system.inputs(), degree + 1)};
  for (int k = 0; k <= degree; ++k) {
    const RowVectorXd coefficient =
        std::pow(time_unit, k) * residual.coefficients[static_cast<std::size_t>(k)];
    row.outputs.col(k) = coefficient.head(system.outputs()).transpose();
    row.inputs.col(k) = coefficient.tail(system.inputs()).transpose();
  }
  return row;
}

}  // namespace mjdiag
