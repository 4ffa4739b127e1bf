#include "mjdiag/discovery/fitting/profile_interval.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOutside = 0.05;
constexpr const char* kProfiles = "skew intervals";

/// Where the profile of one parameter crosses.
class Profile {
 public:
  /// @param direction  how all others follow, per unit of parameter `index`
  /// @param share      of the work that is left, for one end
  Profile(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
          const CauseFit& fit, Index index, VectorXd direction, double crossing,
          double share)
      : problem_(problem),
        candidates_(candidates),
        fit_(fit),
        index_(index),
        direction_(std::move(direction)),
        crossing_(crossing),
        share_(share / kSteps) {}

  /// @param step  to where a quadratic one crosses, with its sign
  /// @param bound of the parameter on that side
  double End(double step, double bound) const;

 private:
  double Value() const { return Flatten(fit_.causes)[index_]; }
  static constexpr int kSteps = 6;

  /// Root of what is lost over the crossing, 1 at an end; infinite where the plant
  /// cannot be run, not a number where the share is used up.
  double Lost(double step) const;
  double Clipped(double step, double bound) const {
    return step < 0.0 ? std::max(step, bound - Value())
                      : std::min(step, bound - Value());
  }

  const DiscoveryProblem& problem_;
  const std::vector<Candidate>& candidates_;
  const CauseFit& fit_;
  Index index_;
  VectorXd direction_;
  double crossing_;
  double share_;  // of a step
};

double Profile::Lost(double step) const {
  VectorXd theta = Flatten(fit_.causes) + step * direction_;
  const std::vector<FitParameter> parameters = ParametersOf(candidates_, fit_.causes);
  for (Index i = 0; i < theta.size(); ++i) {
    const FitParameter& parameter = parameters[static_cast<std::size_t>(i)];
    theta[i] = std::clamp(theta[i], parameter.lower, parameter.upper);
  }
  // To a tenth of what a crossing is.
  const double tolerance = 0.1 * crossing_ / (FittedValues(problem_) * fit_.train);
  FitOptions options = CompareFrom(&fit_.jacobian, 4, tolerance, share_);
  options.held = index_;
  const auto held = TryFit(
      problem_, candidates_,
      {WithValues(fit_.causes, theta), fit_.numbers, fit_.prior_weight}, options);
  if (held ? held->cut : problem_.work()->IsStopped()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (!held) return std::numeric_limits<double>::infinity();
  const double lost = FittedValues(problem_) * (held->train - fit_.train) +
                      fit_.prior_weight * (held->prior - fit_.prior);
  return std::sqrt(std::max(lost, 0.0) / crossing_);
}

double Profile::End(double step, double bound) const {
  constexpr double kNear = 0.05;
  // The root of what is lost grows nearly in proportion: false position from 0 on.
  double below = 0.0;
  double lost_below = 0.0;
  double above = 0.0;
  double lost_above = std::numeric_limits<double>::infinity();
  double next = Clipped(step, bound);
  for (int i = 0; i < kSteps; ++i) {
    const double lost = Lost(next);
    if (std::isnan(lost)) return Value() + Clipped(step, bound);
    if (std::abs(lost - 1.0) < kNear) return Value() + next;
    if (lost < 1.0) {
      if (next == Clipped(2.0 * next, bound)) return bound;
      below = next;
      lost_below = lost;
    } else {
      above = next;
      lost_above = lost;
    }
    if (above == 0.0) {
      next = Clipped(below * std::clamp(1.0 / std::max(lost_below, 1e-3), 1.2, 3.0),
                     bound);
    } else if (std::isfinite(lost_above)) {
      const double part = (1.0 - lost_below) / (lost_above - lost_below);
      next = below + std::clamp(part, 0.1, 0.9) * (above - below);
    } else {
      next = 0.5 * (below + above);
    }
  }
  return Value() + next;
}

/// Whether the law of a candidate has a shape, and not only sizes of its parts.
bool HasShape(const Candidate& candidate) {
  return std::ranges::any_of(candidate.parameters, IsShape, &FitParameter::role);
}

/// For every parameter of the causes whether its profile has to be followed: of laws
/// with a shape, where a parameter is not known to a small part of itself.
std::vector<bool> NeedProfile(const std::vector<Candidate>& candidates,
                              const std::vector<FittedCause>& causes,
                              const MatrixXd& covariance) {
  constexpr double kSharp = 0.05;
  std::vector<bool> needed;
  for (const FittedCause& cause : causes) {
    const Candidate& candidate = candidates[cause.candidate];
    for (std::size_t k = 0; k < candidate.parameters.size(); ++k) {
      const auto i = static_cast<Index>(needed.size());
      const double size = candidate.parameters[k].role == Role::kPhase
                              ? 1.0
                              : std::abs(cause.value[static_cast<Index>(k)]);
      const double sd = std::sqrt(covariance(i, i));
      needed.push_back(HasShape(candidate) && std::isfinite(sd) && sd > kSharp * size);
    }
  }
  return needed;
}

}  // namespace

std::vector<Interval> ParameterIntervals(const DiscoveryProblem& problem,
                                         const std::vector<Candidate>& candidates,
                                         const CauseFit& fit,
                                         const MatrixXd& covariance) {
  const VectorXd theta = Flatten(fit.causes);
  const ScaledInformation information = InformationOf(problem, candidates, fit);
  const MatrixXd all = information.scale.asDiagonal() * InverseOf(information).matrix *
                       information.scale.asDiagonal();
  const MatrixXd C = all.bottomRightCorner(theta.size(), theta.size());
  const std::vector<FitParameter> parameters = ParametersOf(candidates, fit.causes);
  // Free simulations take long, and their values are pulled by more than noise.
  const std::vector<bool> needed =
      problem.IsFree() ? std::vector<bool>(parameters.size(), false)
                       : NeedProfile(candidates, fit.causes, covariance);
  const DiscoveryProblem seen = problem.TrainPart();
  const double normal = TwoSidedNormalQuantile(kOutside);
  const double chi_squared = ChiSquaredQuantile(kOutside, 1.0);
  std::vector<Interval> intervals(parameters.size());
  const auto ends = 2 * static_cast<int>(std::ranges::count(needed, true));
  const bool follow = ends == 0 || problem.work()->MayBegin(kProfiles);
  const double share = problem.work()->Share(ends);
  ParallelFor(2 * static_cast<int>(parameters.size()), [&](int number) {
    const Index i = number / 2;
    const double side = number % 2 == 0 ? -1.0 : 1.0;
    const auto p = static_cast<std::size_t>(i);
    double& end = side < 0.0 ? intervals[p].min : intervals[p].max;
    const double sd = std::sqrt(covariance(i, i));
    end = theta[i] + side * normal * sd;
    if (!needed[p] || !follow) return;
    const double colour = covariance(i, i) / C(i, i);
    const Profile profile(seen, candidates, fit, i, C.col(i) / C(i, i),
                          chi_squared * colour, share);
    end = profile.End(side * normal * sd,
                      side < 0.0 ? parameters[p].lower : parameters[p].upper);
  });
  if (ends > 0) problem.work()->MayBegin(kProfiles);  // kept if it was cut short
  return intervals;
}

}  // namespace mjdiag
