#include "mjdiag/discovery/fitting/cause_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "mjdiag/discovery/fitting/fit_coordinates.h"
#include "mjdiag/discovery/fitting/prior_cost.h"
#include "mjdiag/discovery/fitting/scale_gauge.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The innovations as a function of theta, with the last run kept: Ceres asks for the
/// value and then, at the same place, for the derivatives.
class Simulator {
 public:
  Simulator(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
            const std::vector<FittedCause>& causes, const FitOptions& options)
      : problem_(problem),
        candidates_(candidates),
        causes_(causes),
        numbers_(static_cast<Index>(problem.numbers().size())),
        initial_jacobian_(options.initial_jacobian),
        secant_(options.secant),
        first_order_(options.first_order),
        share_(options.share),
        closing_(options.closing) {
    for (const DoubtedNumber& number : problem.numbers()) {
      parameters_.push_back(
          {"number", Role::kAmplitude, number.Least(), number.Most(), 0.0, 1.0});
    }
    for (const FitParameter& parameter : ParametersOf(candidates, causes)) {
      parameters_.push_back(parameter);
    }
    if (numbers_ > 1) gauges_ = ScaleGauges(problem, candidates, causes);
  }
  const std::vector<FitParameter>& parameters() const { return parameters_; }

  const VectorXd& Residual(const VectorXd& theta) {
    if (residual_.size() == 0 || theta != theta_) {
      residual_ = RunAt(theta);
      theta_ = theta;
    }
    return residual_;
  }

  double Used() const { return runs_ * problem_.RunWork(); }
  /// Whether the fit was asked to end, or has done its share of the work. Where no run
  /// is under way the latter is the same every time.
  bool IsOver() const { return IsStopped() || Used() > share_; }

  /// J at theta for a step of the fit, all samples. CutShort without a first one.
  const MatrixXd& StepJacobian(const VectorXd& theta) {
    if (jacobian_.size() == 0) {
      RequireShareFor(theta.size() -
                      (initial_jacobian_ != nullptr ? initial_jacobian_->cols() : 0));
      jacobian_ = Differences(theta, initial_jacobian_, true);
      NoteJacobian(theta, initial_jacobian_ == nullptr && numbers_ == 0);
    } else if (theta != jacobian_theta_ && first_order_ && Allows(theta.size())) {
      jacobian_ = Differences(theta, nullptr, true);
      NoteJacobian(theta, numbers_ == 0);
    } else if (theta != jacobian_theta_ && (secant_ || first_order_)) {
      Broyden(theta);
      NoteJacobian(theta, false);
    } else if (theta != jacobian_theta_) {
      return Jacobian(theta);
    }
    return jacobian_;
  }

  /// theta, or as good a one that keeps better to what is known beforehand: what no run
  /// tells (scale_gauge.h).
  VectorXd Kept(const VectorXd& theta) {
    if (untold_.empty()) return theta;
    constexpr double kAsGood = 0.1;  // squared innovations
    const double before = Residual(theta).squaredNorm();
    VectorXd kept = KeptToWhatIsKnown(untold_, theta, parameters_);
    if (Residual(kept).squaredNorm() > before + kAsGood) return theta;
    // The columns that multiplied what has grown are smaller by as much.
    for (Index i = 0; i < theta.size(); ++i) {
      double grown = 1.0;
      for (const ScaleGauge& gauge : untold_) {
        if (gauge.exponent[i] == 0.0) continue;
        grown = (kept[i] + gauge.offset[i]) / (theta[i] + gauge.offset[i]);
      }
      if (std::isfinite(grown) && grown != 0.0) jacobian_.col(i) /= grown;
    }
    jacobian_theta_ = kept;
    return kept;
  }
  /// J of the last step of the fit.
  const MatrixXd& jacobian() const { return jacobian_; }
  bool exact() const { return exact_; }

  /// J at theta by differences, all samples; that of the last step if the share does
  /// not allow for it.
  const MatrixXd& Jacobian(const VectorXd& theta) {
    if (jacobian_.size() > 0 && !Allows(theta.size() + numbers_)) return jacobian_;
    if (!exact_ || theta != jacobian_theta_) {
      jacobian_ = Differences(theta, nullptr, false);
      NoteJacobian(theta, true);
    }
    return jacobian_;
  }

 private:
  bool IsStopped() const { return !closing_ && problem_.work()->IsStopped(); }
  bool Allows(Index runs) const {
    return !IsStopped() &&
           Used() + static_cast<double>(runs) * problem_.RunWork() <= share_;
  }
  void RequireShareFor(Index runs) const {
    if (!Allows(runs)) throw CutShort();
  }

  void NoteJacobian(const VectorXd& theta, bool exact) {
    exact_ = exact;
    if (numbers_ > 1) {
      untold_ = Untold(gauges_, theta, jacobian_);
      RemoveGauges(untold_, theta, jacobian_);
    }
    jacobian_theta_ = theta;
    jacobian_residual_ = Residual(theta);
  }

  /// J with its first columns from `initial`, if any.
  /// @param rough  by z
  MatrixXd Differences(const VectorXd& theta, const MatrixXd* initial, bool rough) {
    const VectorXd base = Residual(theta);
    const double duration =
        static_cast<double>(problem_.run().samples()) * problem_.run().sample_time;
    MatrixXd J(base.size(), theta.size());
    Index kept = initial != nullptr ? initial->cols() : 0;
    if (kept > 0) J.leftCols(kept) = initial->topRows(base.size());
    if (numbers_ > 0 && (kept == 0 || !HasNumbersOf(theta, J))) {
      kept = std::max(kept, numbers_);
      const Changes causes = CausesAt(theta);
      const VectorXd z = theta.head(numbers_);
      constexpr int kOnePass = 4;  // as many runs
      const int differences = 2 * static_cast<int>(numbers_);
      rough = rough && differences > kOnePass;
      runs_ += rough ? kOnePass : differences;
      J.leftCols(numbers_) = rough ? problem_.RoughNumberJacobian(causes, z)
                                   : problem_.NumberJacobian(causes, z);
    }
    ParallelForAll(static_cast<int>(theta.size() - kept), [&](int number) {
      const Index i = kept + number;
      J.col(i) = Difference(theta, base, i, duration);
    });
    return J;
  }

  /// Whether the derivatives by z are those beside the causes: they are 0 of the numbers
  /// that causes stand for, and of no others. Those that have to be 0 are made so.
  bool HasNumbersOf(const VectorXd& theta, MatrixXd& J) const {
    const std::vector<bool> stood_for = problem_.StoodFor(CausesAt(theta));
    for (Index i = 0; i < numbers_; ++i) {
      if (stood_for[static_cast<std::size_t>(i)]) {
        J.col(i).setZero();
      } else if (J.col(i).isZero(0.0)) {
        return false;
      }
    }
    return true;
  }

  /// J += (dr - J s) (D s)^T / (s^T D s) for the step s since the last J, with D the
  /// squared norms of its columns: parameters of all units count alike.
  void Broyden(const VectorXd& theta) {
    const VectorXd step = theta - jacobian_theta_;
    const VectorXd metric =
        jacobian_.colwise().squaredNorm().transpose().cwiseProduct(step);
    const double length = step.dot(metric);
    if (!(length > 0.0)) return;
    const VectorXd missed = Residual(theta) - jacobian_residual_ - jacobian_ * step;
    jacobian_ += missed * (metric / length).transpose();
  }

  /// Column i of J. A machine that sticks and slips may answer to any change, however
  /// small, with a course of its own: a difference that a step ten times as large does
  /// not raise. Then only large steps show the derivative.
  VectorXd Difference(const VectorXd& theta, const VectorXd& base, Index i,
                      double duration) const {
    // Beside numbers in doubt, which may act together just as a parameter does, what the
    // nonlinear part leaves of a step must not seem to tell them apart.
    const double first = numbers_ > 0 ? 1e-6 : 1e-4;
    constexpr double kLast = 0.1;
    constexpr double kNoticed = 10.0;  // standard deviations of the noise
    constexpr double kGrows = 5.0;
    const FitParameter& parameter = parameters_[static_cast<std::size_t>(i)];
    const double scale = ScaleOf(parameter, theta[i], duration);
    const auto quotient = [&](double step) {
      if (theta[i] + step > parameter.upper) step = -step;
      VectorXd moved = theta;
      moved[i] += step;
      return VectorXd((RunAt(moved) - base) / step);
    };
    VectorXd found = quotient(first * scale);
    for (double part = first; part < kLast; part *= 10.0) {
      if (found.norm() * part * scale < kNoticed) break;
      try {
        VectorXd further = quotient(10.0 * part * scale);
        if (10.0 * further.norm() > kGrows * found.norm()) break;
        found = std::move(further);
      } catch (const NumericalError&) {
        break;
      } catch (const InputError&) {
        break;
      }
    }
    return found;
  }
  Changes CausesAt(const VectorXd& theta) const {
    return ChangesOf(candidates_,
                     WithValues(causes_, theta.tail(theta.size() - numbers_)));
  }
  VectorXd RunAt(const VectorXd& theta) const {
    if (IsStopped()) throw CutShort();
    ++runs_;
    return problem_.Residual(
        problem_.WithNumbers(CausesAt(theta), theta.head(numbers_)));
  }

  const DiscoveryProblem& problem_;
  const std::vector<Candidate>& candidates_;
  const std::vector<FittedCause>& causes_;
  Index numbers_;
  const MatrixXd* initial_jacobian_;
  bool secant_;
  bool first_order_;
  double share_;
  bool closing_;
  mutable std::atomic<int> runs_ = 0;
  std::vector<FitParameter> parameters_;
  VectorXd theta_;
  VectorXd residual_;
  bool exact_ = false;  // jacobian_ is all of differences
  MatrixXd jacobian_;   // of the last step of the fit, with where it was taken
  VectorXd jacobian_theta_;
  VectorXd jacobian_residual_;
  std::vector<ScaleGauge> gauges_;
  std::vector<ScaleGauge> untold_;  // those that J says nothing of
};

class InnovationCost final : public ceres::CostFunction {
 public:
  InnovationCost(Simulator& simulator, Index first, Index count, Index parameters,
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
  Simulator& simulator_;
  Index first_;
  Index count_;
  const FitCoordinates& coordinates_;
};

/// Ends a fit that is over with the values it has.
class EndWhenOver final : public ceres::IterationCallback {
 public:
  explicit EndWhenOver(const Simulator& simulator) : simulator_(simulator) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return simulator_.IsOver() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Simulator& simulator_;
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
  Simulator simulator(seen, candidates, start.causes, options);
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
