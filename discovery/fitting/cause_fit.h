#pragma once
// Parameters of causes by full simulation: the innovations of the nonlinear plant with
// the causes in it are made as small as they get,
//
//   min over theta of  sum over train samples of |e_k(theta)|^2,   bounds on theta
//
// by Levenberg and Marquardt (Ceres), with e scaled to unit variance under sensor noise
// alone. The numbers of the plant that are in doubt are fitted with them, theta = (z,
// parameters of the causes), and what is known of them beforehand counts as so many
// measurements, + |z|^2. Derivatives by parameters of causes are forward differences of
// whole runs, side by side; see DiscoveryProblem::NumberJacobian for those by z.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

struct CauseFit : FittedModel {
  Eigen::VectorXd residual;  ///< scaled innovations of all samples
  Eigen::MatrixXd jacobian;  ///< J = d residual / d theta of the train part
  bool exact = false;        ///< J by differences at theta, not by secants
  double prior = 0.0;        ///< PriorOf
  double train = 0.0;        ///< mean square of the train part
  double held_out = 0.0;     ///< of the rest; 0 without
  bool cut = false;          ///< ended by its share of the work, or asked to
  double spent = 0.0;        ///< work [s]
};

struct FitOptions {
  int iterations = 12;
  /// Of the sum of squares, relative: when to stop.
  double tolerance = 1e-6;
  /// Compute J at the solution; else it is that of the last step.
  bool jacobian = true;
  /// J of the first parameters at the start, instead of differences: of causes that
  /// have been fitted before. Not owned.
  const Eigen::MatrixXd* initial_jacobian = nullptr;
  /// J from differences at the start only, then by Broyden's updates: one run a step
  /// instead of one for every parameter. Near enough to compare causes.
  bool secant = false;
  /// J of every step to first order along its run as far as numbers are concerned
  /// (DiscoveryProblem::RoughNumberJacobian), and from differences of the causes: where a
  /// fit begins far from where it ends.
  bool first_order = false;
  /// Place of a parameter of the causes that keeps its value.
  std::optional<Eigen::Index> held = std::nullopt;
  /// Work that it may do [s]: then it ends with the values it has, and no further move
  /// is begun (Work::CutShort), unless it only betters what is known already.
  double share = Work::kUnlimited;
  bool only_betters = false;
  /// Whether it goes on where the discovery was asked to end: what has to be known of
  /// an answer.
  bool closing = false;
};

/// A fit ended before it had any values of its own: it was asked to, or its share of
/// the work was used up.
class CutShort : public std::runtime_error {
 public:
  CutShort() : std::runtime_error("fit: ended before its first step") {}
};

/// Innovations that a fit sees, all channels: the sum of squares of noise alone, and of
/// a fit over its mean square `train`.
double FittedValues(const DiscoveryProblem& problem);

/// @param start  causes with values to start from, within their bounds, and numbers
/// NumericalError if the run with the start diverges; CutShort.
CauseFit FitCauses(const DiscoveryProblem& problem,
                   const std::vector<Candidate>& candidates, const FittedModel& start,
                   const FitOptions& options);

/// With its values as they are, and no J: where a fit came to nothing, and what is left of
/// the work does not matter. NumericalError if the run diverges.
CauseFit AsItIs(const DiscoveryProblem& problem,
                const std::vector<Candidate>& candidates, const FittedModel& model);

/// For fits that are compared: by secants, from a J of the first parameters (or null),
/// none computed at the end.
/// @param share  of the work that is left [s]
FitOptions CompareFrom(const Eigen::MatrixXd* initial_jacobian, int iterations,
                       double tolerance, double share);

/// The same; none where the start diverges or takes away more than there is, or if it
/// is cut short.
std::optional<CauseFit> TryFit(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const FittedModel& start, const FitOptions& options);

/// A fit but for its causes in some places: the rest, which columns of J belong to it, and
/// J of it.
FittedModel ModelWithout(const FittedModel& fit,
                         const std::vector<std::size_t>& places);
std::vector<Eigen::Index> ColumnsWithout(const FittedModel& fit,
                                         const std::vector<std::size_t>& places);
Eigen::MatrixXd JacobianWithout(const CauseFit& fit,
                                const std::vector<std::size_t>& places);

}  // namespace mjdiag
