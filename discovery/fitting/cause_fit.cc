#include "mjdiag/discovery/fitting/cause_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mjdiag/discovery/fitting/fit_coordinates.h"
#include "mjdiag/discovery/fitting/fit_simulator.h"
#include "mjdiag/discovery/fitting/prior_cost.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class InnovationCost final : public ceres::CostFunction {
 public:
  InnovationCost(FitSimulator& simulator, Index first, Index count, Index parameters,
                 const FitCoordinates& coordinates)
      : simulator_(simulator), first_(first), count_(count), coordinates_(coordinates) {
    set_num_residuals(static_cast<int>(count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters));
  }
  bool Evaluate(const double* const* blocks, double* residuals,
                double** jacobians) const override {
    const Index size = parameter_block_sizes()[0];
    const VectorXd theta =
        coordinates_.ToTheta(Eigen::Map<const VectorXd>(blocks[0], size));
    try {
      Eigen::Map<VectorXd>(residuals, count_) =
          simulator_.Residual(theta).segment(first_, count_);
      if (jacobians == nullptr || jacobians[0] == nullptr) return true;
      using RowMajor =
          Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const MatrixXd J = simulator_.StepJacobian(theta).middleRows(first_, count_) *
                         coordinates_.SlopeAt(theta).asDiagonal();
      if (!J.allFinite()) return false;
      if (size == 1) {
        Eigen::Map<VectorXd>(jacobians[0], count_) = J.col(0);
      } else {
        Eigen::Map<RowMajor>(jacobians[0], count_, size) = J;
      }
      return true;
    } catch (const NumericalError&) {
      return false;  // diverged: a step that far is refused
    } catch (const InputError&) {
      return false;  // takes away more than there is
    } catch (const CutShort&) {
      return false;
    }
  }

 private:
  FitSimulator& simulator_;
  Index first_;
  Index count_;
  const FitCoordinates& coordinates_;
};

/// Ends a fit that is over with the values it has.
class EndWhenOver final : public ceres::IterationCallback {
 public:
  explicit EndWhenOver(const FitSimulator& simulator) : simulator_(simulator) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return simulator_.IsOver() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                               : ceres::SOLVER_CONTINUE;
  }

 private:
  const FitSimulator& simulator_;
};

void SetBounds(ceres::Problem& problem, double* x,
               const std::vector<FitParameter>& parameters,
               const FitCoordinates& coordinates) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const int index = static_cast<int>(i);
    const double lower = coordinates.Bound(index, parameters[i].lower);
    const double upper = coordinates.Bound(index, parameters[i].upper);
    if (std::isfinite(lower)) problem.SetParameterLowerBound(x, index, lower);
    if (std::isfinite(upper)) problem.SetParameterUpperBound(x, index, upper);
  }
}

}  // namespace

double FittedValues(const DiscoveryProblem& problem) {
  return problem.MeasuredValues(problem.skip(), problem.train());
}

CauseFit FitCauses(const DiscoveryProblem& problem,
                   const std::vector<Candidate>& candidates, const FittedModel& start,
                   const FitOptions& options) {
  const Index channels = problem.run().outputs.rows();
  const Index first = channels * problem.skip();
  const Index count = channels * (problem.train() - problem.skip());
  CauseFit fit;
  const auto numbers = static_cast<Index>(problem.numbers().size());
  fit.causes = start.causes;
  fit.prior_weight = start.prior_weight;
  fit.numbers = start.numbers.size() > 0 ? start.numbers : VectorXd::Zero(numbers);
  const std::vector<bool> stood_for =
      problem.StoodFor(ChangesOf(candidates, start.causes));
  for (Index i = 0; i < numbers; ++i) {
    if (stood_for[static_cast<std::size_t>(i)]) fit.numbers[i] = 0.0;
  }
  // What is held out need not be run while the fit goes on.
  const DiscoveryProblem seen = problem.TrainPart();
  FitSimulator simulator(seen, candidates, start.causes, options);
  const VectorXd values = Flatten(start.causes);
  VectorXd theta(numbers + values.size());
  theta << fit.numbers, values;
  const bool moves = theta.size() > 0 && (options.iterations > 0 || options.jacobian);
  if (moves) {
    // Throws where the first values cannot be run; Ceres would write to stderr.
    if (!simulator.StepJacobian(theta).allFinite()) {
      throw NumericalError("fit: the run with the first values diverges");
    }
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    const FitCoordinates coordinates =
        numbers > 0 ? FitCoordinates::About(simulator.parameters(), theta,
                                            seen.FittedDuration())
                    : FitCoordinates::Plain(theta.size());
    VectorXd x = coordinates.FromTheta(theta);
    InnovationCost cost(simulator, first, count, theta.size(), coordinates);
    ceres::Problem least_squares(ownership);
    least_squares.AddResidualBlock(&cost, nullptr, x.data());
    SetBounds(least_squares, x.data(), simulator.parameters(), coordinates);
    PriorCost prior(simulator.parameters(), coordinates, start.prior_weight);
    if (prior.num_residuals() > 0) {
      least_squares.AddResidualBlock(&prior, nullptr, x.data());
    }
    const int size = static_cast<int>(theta.size());
    if (options.held && size == 1) {
      least_squares.SetParameterBlockConstant(x.data());
    } else if (options.held) {
      const int held = static_cast<int>(numbers + *options.held);
      least_squares.SetManifold(x.data(), new ceres::SubsetManifold(size, {held}));
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = options.iterations;
    solver.function_tolerance = options.tolerance;
    solver.parameter_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    if (numbers > 0) {
      // Combinations that only what is known beforehand tells are the ones that a step
      // goes too far along: steps are held back in its units, not in those of what the
      // data tell of single parameters.
      solver.jacobi_scaling = false;
      solver.min_lm_diagonal = 1.0;
      solver.max_lm_diagonal = 1.0;
      solver.initial_trust_region_radius = 1.0;
    }
    // With bounds Ceres searches along every step; a cubic would ask for J there.
    solver.line_search_interpolation_type = ceres::QUADRATIC;
    solver.max_num_line_search_step_size_iterations = 5;
    solver.use_nonmonotonic_steps = true;
    EndWhenOver end(simulator);
    solver.callbacks.push_back(&end);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &least_squares, &summary);
    fit.cut = summary.termination_type == ceres::USER_SUCCESS;
    if (fit.cut && !options.only_betters) problem.work()->CutShort();
    // Asked to end in the midst of a step, of which nothing is left.
    if (!summary.IsSolutionUsable() && simulator.IsOver()) throw CutShort();
    if (!summary.IsSolutionUsable()) {
      throw NumericalError("fit: the run with the first values diverges");
    }
    theta = coordinates.ToTheta(x);
    if (!options.held) theta = simulator.Kept(theta);
    fit.numbers = theta.head(numbers);
    fit.causes = WithValues(start.causes, theta.tail(values.size()));
  }
  if (moves) {
    fit.jacobian = options.jacobian ? simulator.Jacobian(theta) : simulator.jacobian();
    fit.exact = options.jacobian && simulator.exact();
  }
  const Index samples = problem.run().samples();
  fit.residual = problem.train() == samples
                     ? simulator.Residual(theta)
                     : problem.Residual(ChangesOf(problem, candidates, fit));
  fit.prior = PriorOf(candidates, fit);
  fit.spent = simulator.Used();
  fit.train = MeanSquare(problem, fit.residual, problem.skip(), problem.train());
  fit.held_out = MeanSquare(problem, fit.residual, problem.train(), samples);
  return fit;
}

CauseFit AsItIs(const DiscoveryProblem& problem,
                const std::vector<Candidate>& candidates, const FittedModel& model) {
  return FitCauses(problem, candidates, model,
                   {.iterations = 0, .jacobian = false, .closing = true});
}

FitOptions CompareFrom(const MatrixXd* initial_jacobian, int iterations,
                       double tolerance, double share) {
  return {.iterations = iterations,
          .tolerance = tolerance,
          .jacobian = false,
          .initial_jacobian = initial_jacobian,
          .secant = true,
          .share = share};
}

std::optional<CauseFit> TryFit(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const FittedModel& start, const FitOptions& options) {
  try {
    return FitCauses(problem, candidates, start, options);
  } catch (const NumericalError&) {
    return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const CutShort&) {
    if (!options.only_betters) problem.work()->CutShort();
    return std::nullopt;
  }
}

FittedModel ModelWithout(const FittedModel& fit,
                         const std::vector<std::size_t>& places) {
  return {Without(fit.causes, places), fit.numbers, fit.prior_weight};
}

std::vector<Index> ColumnsWithout(const FittedModel& fit,
                                  const std::vector<std::size_t>& places) {
  std::vector<Index> columns(static_cast<std::size_t>(fit.numbers.size()));
  std::iota(columns.begin(), columns.end(), 0);
  Index next = fit.numbers.size();
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    for (Index k = 0; k < fit.causes[i].value.size(); ++k, ++next) {
      if (std::ranges::find(places, i) == places.end()) columns.push_back(next);
    }
  }
  return columns;
}

MatrixXd JacobianWithout(const CauseFit& fit, const std::vector<std::size_t>& places) {
  if (fit.jacobian.cols() == 0) return fit.jacobian;
  return fit.jacobian(Eigen::all, ColumnsWithout(fit, places));
}

}  // namespace mjdiag
