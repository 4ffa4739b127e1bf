#include "mjdiag/discovery/fit/model_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Residuals at x.
class Innovations {
 public:
  Innovations(const MachineWith& machine_with, const MeasuredRun& run,
              const FilterPath& path, const KeptGains& gains, Model model,
              std::vector<Coordinate> coordinates)
      : machine_with_(machine_with),
        run_(run),
        path_(path),
        gains_(gains),
        model_(std::move(model)),
        coordinates_(std::move(coordinates)) {}

  Index rows() const { return gains_.rows(); }
  Index size() const { return std::ssize(coordinates_); }
  const std::vector<Coordinate>& coordinates() const { return coordinates_; }

  const VectorXd& Of(const VectorXd& x) {
    if (kept_.size() > 0 && x == at_) return kept_;
    kept_ = RunAt(x);
    at_ = x;
    return kept_;
  }

  /// At x, or where it was taken last: as long as innovations change little it does, too,
  /// and it takes as many runs as there are coordinates.
  const MatrixXd& Jacobian(const VectorXd& x) {
    constexpr double kLittle = 0.01;
    const VectorXd base = Of(x);
    if (J_.size() > 0 && std::abs(base.squaredNorm() - J_of_) <= kLittle * J_of_) {
      return J_;
    }
    MatrixXd J(rows(), size());
    ParallelForAll(static_cast<int>(size()), [&](int number) {
      const Index i = number;
      const Coordinate& one = coordinates_[static_cast<std::size_t>(i)];
      double step = one.is_log ? 1e-4 : std::max(1e-3 * std::abs(x[i]), 1e-6);
      if (x[i] + step > one.upper) step = -step;
      VectorXd moved = x;
      moved[i] += step;
      J.col(i) = (RunAt(moved) - base) / step;
    });
    J_ = std::move(J);
    J_of_ = base.squaredNorm();
    return J_;
  }

 private:
  VectorXd RunAt(const VectorXd& x) const {
    return PredictAlong(machine_with_(At(coordinates_, model_, x)), run_, path_,
                        gains_);
  }

  const MachineWith& machine_with_;
  const MeasuredRun& run_;
  const FilterPath& path_;
  const KeptGains& gains_;
  Model model_;
  std::vector<Coordinate> coordinates_;
  VectorXd at_, kept_;
  MatrixXd J_;
  double J_of_ = 0.0;  // squared innovations where it was taken
};

class InnovationCost final : public ceres::CostFunction {
 public:
  explicit InnovationCost(Innovations& innovations) : innovations_(innovations) {
    set_num_residuals(static_cast<int>(innovations.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(innovations.size()));
  }
  bool Evaluate(const double* const* blocks, double* residuals,
                double** jacobians) const override {
    const VectorXd x = VectorXd::Map(blocks[0], innovations_.size());
    try {
      VectorXd::Map(residuals, innovations_.rows()) = innovations_.Of(x);
      if (jacobians == nullptr || jacobians[0] == nullptr) return true;
      using RowMajor =
          Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const MatrixXd& J = innovations_.Jacobian(x);
      if (!J.allFinite()) return false;
      if (J.cols() == 1) {
        VectorXd::Map(jacobians[0], J.rows()) = J.col(0);
      } else {
        Eigen::Map<RowMajor>(jacobians[0], J.rows(), J.cols()) = J;
      }
      return true;
    } catch (const NumericalError&) {
      return false;  // diverged: a step that far is refused
    } catch (const InputError&) {
      return false;  // takes away more than there is
    }
  }

 private:
  Innovations& innovations_;
};

/// What is known beforehand: w^T x has a standard deviation of 1.
class KnownCost final : public ceres::CostFunction {
 public:
  explicit KnownCost(VectorXd w) : w_(std::move(w)) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(w_.size()));
  }
  bool Evaluate(const double* const* blocks, double* residuals,
                double** jacobians) const override {
    residuals[0] = w_.dot(VectorXd::Map(blocks[0], w_.size()));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      VectorXd::Map(jacobians[0], w_.size()) = w_;
    }
    return true;
  }

 private:
  VectorXd w_;
};

}  // namespace

MachineWith InTime(MachineWith machine_with, std::function<bool()> is_over) {
  return [machine_with = std::move(machine_with),
          is_over = std::move(is_over)](const Model& model) {
    if (is_over()) throw NumericalError("fit: asked to end");
    return machine_with(model);
  };
}

ModelFit FitModel(const MachineWith& machine_with, const MeasuredRun& run,
                  const FilterPath& path, const KeptGains& gains,
                  const std::vector<Block>& blocks, const Model& start,
                  int iterations) {
  const std::vector<Coordinate> coordinates = CoordinatesOf(blocks, start);
  const MatrixXd R = WhiteningOf(blocks, start, coordinates);
  Innovations innovations(machine_with, run, path, gains, start, coordinates);
  VectorXd x = Place(coordinates, start);
  innovations.Of(x);
  if (x.size() > 0 && iterations > 0) {
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    InnovationCost cost(innovations);
    problem.AddResidualBlock(&cost, nullptr, x.data());
    ceres::CauchyLoss loss(std::sqrt(3.0));  // SizePrice
    std::vector<std::unique_ptr<KnownCost>> known;
    for (Index i = 0; i < x.size(); ++i) {
      if (!coordinates[static_cast<std::size_t>(i)].is_known) continue;
      known.push_back(std::make_unique<KnownCost>(R.row(i).transpose()));
      problem.AddResidualBlock(known.back().get(), &loss, x.data());
    }
    for (Index i = 0; i < x.size(); ++i) {
      const Coordinate& one = coordinates[static_cast<std::size_t>(i)];
      const int index = static_cast<int>(i);
      if (std::isfinite(one.lower)) {
        problem.SetParameterLowerBound(x.data(), index, one.lower);
      }
      if (std::isfinite(one.upper)) {
        problem.SetParameterUpperBound(x.data(), index, one.upper);
      }
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = iterations;
    // A hundredth of what one innovation tells.
    solver.function_tolerance = 0.01 / std::max(1.0, innovations.Of(x).squaredNorm());
    solver.parameter_tolerance = 1e-7;
    solver.logging_type = ceres::SILENT;
    solver.line_search_interpolation_type = ceres::QUADRATIC;
    solver.max_num_line_search_step_size_iterations = 5;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
      throw NumericalError("fit: the run with the first values diverges");
    }
  }
  ModelFit fit;
  fit.model = At(coordinates, start, x);
  fit.deviance = innovations.Of(x).squaredNorm() + gains.log_determinant;
  for (const Member& member : fit.model) {
    fit.prior +=
        blocks[member.block].price + SizePrice(blocks[member.block], member.values);
  }
  if (x.size() > 0) {
    const MatrixXd& J = innovations.Jacobian(x);
    const Eigen::LLT<MatrixXd> solved(J.transpose() * J + R.transpose() * R);
    fit.occam = 2.0 * (solved.matrixLLT().diagonal().array().log().sum() -
                       R.diagonal().array().log().sum());
    fit.sd =
        solved.solve(MatrixXd::Identity(x.size(), x.size())).diagonal().cwiseSqrt();
  }
  return fit;
}

}  // namespace mjdiag
