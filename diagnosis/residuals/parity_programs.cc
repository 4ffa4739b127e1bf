#include "mjdiag/diagnosis/residuals/parity_programs.h"

#include <ClpSimplex.hpp>
#include <CoinPackedMatrix.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/model/equilibrate.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Singular values of the equilibrated Hbar, as parts of the largest: those above
/// kNonzero count, those below kZero are rounding. One in between leaves the rank open.
/// A fault column that the null space sees by less than kNonzero is not seen.
constexpr double kNonzero = 1e-11;
constexpr double kZero = 1e-13;

/// Of Clp, in equations and costs of order one; its default is 1e-7.
constexpr double kSolverTolerance = 1e-9;

/// A later solution must be smaller by this part to count as smaller.
constexpr double kTie = 1e-9;

/// Orthonormal columns that span all v with v^T matrix = 0.
MatrixXd LeftNullSpace(const MatrixXd& matrix) {
  const SingularValues svd = LeftSingularVectors(matrix);
  const VectorXd parts = svd.values / svd.values[0];
  const Index rank = (parts.array() > kNonzero).count();
  if (rank < (parts.array() > kZero).count()) {
    throw NumericalError(
        "the rank of Hbar is lost in rounding: pose the model in a unit of time near "
        "its fastest mode");
  }
  return svd.U.rightCols(matrix.rows() - rank);
}

CoinPackedMatrix Packed(const MatrixXd& dense) {
  std::vector<int> rows;
  std::vector<int> columns;
  std::vector<double> values;
  for (Index j = 0; j < dense.cols(); ++j) {
    for (Index i = 0; i < dense.rows(); ++i) {
      if (dense(i, j) == 0.0) continue;
      rows.push_back(static_cast<int>(i));
      columns.push_back(static_cast<int>(j));
      values.push_back(dense(i, j));
    }
  }
  CoinPackedMatrix packed(true, rows.data(), columns.data(), values.data(),
                          static_cast<CoinBigIndex>(values.size()));
  packed.setDimensions(static_cast<int>(dense.rows()), static_cast<int>(dense.cols()));
  return packed;
}

/// The m programs on the variable v = plus - minus, plus and minus >= 0, in one Clp
/// model: min of a weighted norm of v subject to v^T equations = 0 and, for one column
/// j, v^T conditions_j >= 1. From program to program one bound moves, and each starts
/// from the basis of the one before.
class ParityPrograms {
 public:
  ParityPrograms(const MatrixXd& equations, const MatrixXd& conditions,
                 const VectorXd& weights, RelationNorm norm)
      : unknowns_(equations.rows()), first_condition_(equations.cols()) {
    model_.setLogLevel(0);
    model_.setPrimalTolerance(kSolverTolerance);
    model_.setDualTolerance(kSolverTolerance);
    Load(equations, conditions, weights, norm);
  }

  /// The solution of program `column`, if it has one.
  std::optional<VectorXd> Solve(Index column) {
    const int row = static_cast<int>(first_condition_ + column);
    model_.setRowLower(row, 1.0);
    model_.primal();
    if (!model_.isProvenOptimal()) SolveAfresh();
    model_.setRowLower(row, -COIN_DBL_MAX);
    if (model_.isProvenPrimalInfeasible()) return std::nullopt;
    if (!model_.isProvenOptimal()) {
      throw NumericalError("the linear program of fault column " +
                           std::to_string(column) + " is not solved");
    }
    const Eigen::Map<const VectorXd> solution(model_.primalColumnSolution(),
                                              2 * unknowns_);
    return solution.head(unknowns_) - solution.tail(unknowns_);
  }

 private:
  /// From the slack basis, which is dual feasible: the costs are not negative.
  void SolveAfresh() {
    model_.createStatus();
    model_.dual();
  }

  void Load(const MatrixXd& equations, const MatrixXd& conditions,
            const VectorXd& weights, RelationNorm norm) {
    const Index conditions_end = first_condition_ + conditions.cols();
    // The infinity norm is a column t more, with plus_i + minus_i <= t / weights_i.
    const bool bounded = norm == RelationNorm::kInfinity;
    const Index rows = conditions_end + (bounded ? unknowns_ : 0);
    const Index columns = 2 * unknowns_ + (bounded ? 1 : 0);
    MatrixXd matrix = MatrixXd::Zero(rows, columns);
    matrix.topLeftCorner(conditions_end, unknowns_) << equations.transpose(),
        conditions.transpose();
    matrix.block(0, unknowns_, conditions_end, unknowns_) =
        -matrix.topLeftCorner(conditions_end, unknowns_);
    VectorXd cost(columns);
    VectorXd lower = VectorXd::Constant(rows, -COIN_DBL_MAX);
    VectorXd upper = VectorXd::Constant(rows, COIN_DBL_MAX);
    lower.head(first_condition_).setZero();
    upper.head(first_condition_).setZero();
    if (bounded) {
      matrix.bottomLeftCorner(unknowns_, unknowns_).setIdentity();
      matrix.block(conditions_end, unknowns_, unknowns_, unknowns_).setIdentity();
      matrix.bottomRightCorner(unknowns_, 1) = -weights.cwiseInverse();
      upper.tail(unknowns_).setZero();
      cost << VectorXd::Zero(2 * unknowns_), 1.0;
    } else {
      cost << weights, weights;
    }
    const VectorXd lowest = VectorXd::Zero(columns);
    const VectorXd highest = VectorXd::Constant(columns, COIN_DBL_MAX);
    model_.loadProblem(Packed(matrix), lowest.data(), highest.data(), cost.data(),
                       lower.data(), upper.data());
  }

  Index unknowns_;
  Index first_condition_;
  ClpSimplex model_;
};

double Size(const VectorXd& nbar, RelationNorm norm) {
  return norm == RelationNorm::kOne ? nbar.lpNorm<1>() : nbar.lpNorm<Eigen::Infinity>();
}

PolynomialMatrix RelationPolynomial(const VectorXd& nbar, int degree) {
  const Index width = nbar.size() / (degree + 1);
  PolynomialMatrix result;
  for (int i = 0; i <= degree; ++i) {
    result.coefficients.emplace_back(nbar.segment(i * width, width).transpose());
  }
  return result;
}

void CheckDegree(const DaeModel& dae, int degree) {
  if (degree < 0) {
    throw InputError("parity relation", "degree " + std::to_string(degree),
                     "0 or more");
  }
  if (dae.H.cols() == 0 || dae.F.cols() == 0) {
    throw InputError("parity relation",
                     std::to_string(dae.H.cols()) + " unknowns and " +
                         std::to_string(dae.F.cols()) + " fault inputs",
                     "at least one of each");
  }
  if (dae.F.rows() != dae.H.rows()) {
    throw InputError("parity relation",
                     "F with " + std::to_string(dae.F.rows()) + " rows",
                     "as many as H has, " + std::to_string(dae.H.rows()));
  }
}

}  // namespace

std::optional<ParityProgramSolution> SolveParityPrograms(
    const DaeModel& dae, int degree, const ParityProgramOptions& options) {
  CheckDegree(dae, degree);
  const MatrixXd hbar = BarMatrix(dae.H, degree);
  const MatrixXd fbar = BarMatrix(dae.F, degree);
  // Nbar = v^T diag(scaled.rows), and a condition of unit length keeps v of order one.
  const Equilibrated scaled = Equilibrate(hbar);
  const MatrixXd null_space = LeftNullSpace(scaled.matrix);
  const MatrixXd scaled_fbar = scaled.rows.asDiagonal() * fbar;
  const MatrixXd conditions = scaled_fbar.colwise().normalized();
  ParityPrograms programs(scaled.matrix, conditions, scaled.rows / scaled.rows.mean(),
                          options.norm);

  ParityProgramSolution best;
  best.programs = static_cast<int>(fbar.cols());
  for (Index j = 0; j < fbar.cols(); ++j) {
    // What no relation of the null space sees has no solution; Clp, which meets the
    // equations to a tolerance, can find one all the same.
    if ((null_space.transpose() * conditions.col(j)).norm() <= kNonzero) continue;
    const std::optional<VectorXd> solution = programs.Solve(j);
    if (!solution) continue;
    const VectorXd exact = null_space * (null_space.transpose() * *solution);
    if (conditions.col(j).dot(exact) < 0.5) continue;
    ++best.feasible;
    const VectorXd nbar =
        scaled.rows.asDiagonal() * (exact / scaled_fbar.col(j).dot(exact));
    const double size = Size(nbar, options.norm);
    if (best.feasible > 1 && size >= (1.0 - kTie) * best.objective) continue;
    best.N = RelationPolynomial(nbar, degree);
    best.column = static_cast<int>(j);
    best.objective = size;
    best.defect = (nbar.transpose() * hbar).norm() / (nbar.norm() * hbar.norm());
  }
  if (best.feasible == 0) return std::nullopt;
  return best;
}

}  // namespace mjdiag
