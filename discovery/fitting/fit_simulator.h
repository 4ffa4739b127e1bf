#pragma once
// What a fit asks of a machine: innovations at theta = (z, parameters of the causes), and
// their derivatives, by differences of runs, to first order along one, or by secants.

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/fitting/fit_coordinates.h"
#include "mjdiag/discovery/fitting/scale_gauge.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

/// The innovations as a function of theta, with the last run kept: Ceres asks for the
/// value and then, at the same place, for the derivatives.
class FitSimulator {
 public:
  FitSimulator(const DiscoveryProblem& problem,
               const std::vector<Candidate>& candidates,
               const std::vector<FittedCause>& causes, const FitOptions& options)
      : problem_(problem),
        candidates_(candidates),
        causes_(causes),
        numbers_(static_cast<Eigen::Index>(problem.numbers().size())),
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

  const Eigen::VectorXd& Residual(const Eigen::VectorXd& theta) {
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
  const Eigen::MatrixXd& StepJacobian(const Eigen::VectorXd& theta) {
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
  Eigen::VectorXd Kept(const Eigen::VectorXd& theta) {
    if (untold_.empty()) return theta;
    constexpr double kAsGood = 0.1;  // squared innovations
    const double before = Residual(theta).squaredNorm();
    Eigen::VectorXd kept = KeptToWhatIsKnown(untold_, theta, parameters_);
    if (Residual(kept).squaredNorm() > before + kAsGood) return theta;
    // The columns that multiplied what has grown are smaller by as much.
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
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
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  bool exact() const { return exact_; }

  /// J at theta by differences, all samples; that of the last step if the share does
  /// not allow for it.
  const Eigen::MatrixXd& Jacobian(const Eigen::VectorXd& theta) {
    if (jacobian_.size() > 0 && !Allows(theta.size() + numbers_)) return jacobian_;
    if (!exact_ || theta != jacobian_theta_) {
      jacobian_ = Differences(theta, nullptr, false);
      NoteJacobian(theta, true);
    }
    return jacobian_;
  }

 private:
  bool IsStopped() const { return !closing_ && problem_.work()->IsStopped(); }
  bool Allows(Eigen::Index runs) const {
    return !IsStopped() &&
           Used() + static_cast<double>(runs) * problem_.RunWork() <= share_;
  }
  void RequireShareFor(Eigen::Index runs) const {
    if (!Allows(runs)) throw CutShort();
  }

  void NoteJacobian(const Eigen::VectorXd& theta, bool exact) {
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
  Eigen::MatrixXd Differences(const Eigen::VectorXd& theta,
                              const Eigen::MatrixXd* initial, bool rough) {
    const Eigen::VectorXd base = Residual(theta);
    const double duration =
        static_cast<double>(problem_.run().samples()) * problem_.run().sample_time;
    Eigen::MatrixXd J(base.size(), theta.size());
    Eigen::Index kept = initial != nullptr ? initial->cols() : 0;
    if (kept > 0) J.leftCols(kept) = initial->topRows(base.size());
    if (numbers_ > 0 && (kept == 0 || !HasNumbersOf(theta, J))) {
      kept = std::max(kept, numbers_);
      const Changes causes = CausesAt(theta);
      const Eigen::VectorXd z = theta.head(numbers_);
      constexpr int kOnePass = 4;  // as many runs
      const int differences = 2 * static_cast<int>(numbers_);
      rough = rough && differences > kOnePass;
      runs_ += rough ? kOnePass : differences;
      J.leftCols(numbers_) = rough ? problem_.RoughNumberJacobian(causes, z)
                                   : problem_.NumberJacobian(causes, z);
    }
    ParallelForAll(static_cast<int>(theta.size() - kept), [&](int number) {
      const Eigen::Index i = kept + number;
      J.col(i) = Difference(theta, base, i, duration);
    });
    return J;
  }

  /// Whether the derivatives by z are those beside the causes: they are 0 of the numbers
  /// that causes stand for, and of no others. Those that have to be 0 are made so.
  bool HasNumbersOf(const Eigen::VectorXd& theta, Eigen::MatrixXd& J) const {
    const std::vector<bool> stood_for = problem_.StoodFor(CausesAt(theta));
    for (Eigen::Index i = 0; i < numbers_; ++i) {
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
  void Broyden(const Eigen::VectorXd& theta) {
    const Eigen::VectorXd step = theta - jacobian_theta_;
    const Eigen::VectorXd metric =
        jacobian_.colwise().squaredNorm().transpose().cwiseProduct(step);
    const double length = step.dot(metric);
    if (!(length > 0.0)) return;
    const Eigen::VectorXd missed =
        Residual(theta) - jacobian_residual_ - jacobian_ * step;
    jacobian_ += missed * (metric / length).transpose();
  }

  /// Column i of J. A machine that sticks and slips may answer to any change, however
  /// small, with a course of its own: a difference that a step ten times as large does
  /// not raise. Then only large steps show the derivative.
  Eigen::VectorXd Difference(const Eigen::VectorXd& theta, const Eigen::VectorXd& base,
                             Eigen::Index i, double duration) const {
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
      Eigen::VectorXd moved = theta;
      moved[i] += step;
      return Eigen::VectorXd((RunAt(moved) - base) / step);
    };
    Eigen::VectorXd found = quotient(first * scale);
    for (double part = first; part < kLast; part *= 10.0) {
      if (found.norm() * part * scale < kNoticed) break;
      try {
        Eigen::VectorXd further = quotient(10.0 * part * scale);
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
  Changes CausesAt(const Eigen::VectorXd& theta) const {
    return ChangesOf(candidates_,
                     WithValues(causes_, theta.tail(theta.size() - numbers_)));
  }
  Eigen::VectorXd RunAt(const Eigen::VectorXd& theta) const {
    if (IsStopped()) throw CutShort();
    ++runs_;
    return problem_.Residual(
        problem_.WithNumbers(CausesAt(theta), theta.head(numbers_)));
  }

  const DiscoveryProblem& problem_;
  const std::vector<Candidate>& candidates_;
  const std::vector<FittedCause>& causes_;
  Eigen::Index numbers_;
  const Eigen::MatrixXd* initial_jacobian_;
  bool secant_;
  bool first_order_;
  double share_;
  bool closing_;
  mutable std::atomic<int> runs_ = 0;
  std::vector<FitParameter> parameters_;
  Eigen::VectorXd theta_;
  Eigen::VectorXd residual_;
  bool exact_ = false;        // jacobian_ is all of differences
  Eigen::MatrixXd jacobian_;  // of the last step of the fit, with where it was taken
  Eigen::VectorXd jacobian_theta_;
  Eigen::VectorXd jacobian_residual_;
  std::vector<ScaleGauge> gauges_;
  std::vector<ScaleGauge> untold_;  // those that J says nothing of
};

}  // namespace mjdiag
