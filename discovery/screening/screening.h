#pragma once
// Which candidates could explain what is left: every trial (trial.h) is passed through
// the error dynamics and regressed on the innovations, and is worth the square of them
// that it takes away,
//
//   gain = b^T G^-1 b,   G = Phi^T Phi,   b = Phi^T e
//
// with Phi its response, orthogonal to the Jacobian J of what has been found
// already, for those are fitted again together with it. What is known beforehand of the
// numbers of the plant counts as measurements: rows z of the residual, of which J has
// the identity, so that only what leaves the plausible is left to a trial that acts as a
// number does. With noise alone a gain is chi-squared distributed with as many degrees
// of freedom as the trial has amplitudes.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/screening/trial.h"
#include "mjdiag/plugin/replay/error_dynamics.h"

namespace mjdiag {

/// Values to start a fit from, which may lie beyond their bounds (Bounded).
struct Start {
  FittedCause cause;
  double gain = 0.0;  ///< of the squared scaled innovations, less what sizes cost
  int freedom = 1;    ///< amplitudes
};

struct Screening {
  /// The best starts of every candidate that is excited, best first.
  std::vector<Start> starts;
  int trials = 0;  ///< how many were looked at, for the chance of the best
  /// Squared residual that no change of what has been found would take away.
  double rest = 0.0;
};

/// @param dynamics       of the train part at least, in blocks
/// @param residual       scaled innovations, only the train part is used
/// @param jacobian       J of what has been found, (ny samples) x (numbers of the
///                       plant, then parameters); may be empty
/// @param present        what has been found: J has its numbers first
/// @param starts_each    how many starts of one candidate to keep at most
Screening Screen(const DiscoveryProblem& problem,
                 const std::vector<Candidate>& candidates, const ObservedMotion& motion,
                 const ErrorDynamics& dynamics, const Eigen::VectorXd& residual,
                 const Eigen::MatrixXd& jacobian, const FittedModel& present,
                 int starts_each);

/// The same beside the plant as that model has it, on what it leaves.
/// @param jacobian  of the model
Screening ScreenBeside(const DiscoveryProblem& problem,
                       const std::vector<Candidate>& candidates,
                       const FittedModel& present, const Eigen::MatrixXd& jacobian,
                       int starts_each);

/// Starts of one wave (a candidate with a sweep) that promise more than its present
/// period or frequency, best first. Every value of the sweep is judged exactly: Screen,
/// which has many candidates to look at, only estimates the size of most of them. Of a
/// candidate with a frequency but no sweep the best starts. `cause.candidate` of the
/// starts is not set.
std::vector<Start> BetterWaves(const DiscoveryProblem& problem, const Candidate& wave,
                               double present, const ObservedMotion& motion,
                               const ErrorDynamics& dynamics,
                               const Eigen::VectorXd& residual,
                               const Eigen::MatrixXd& jacobian,
                               const FittedModel& beside, int most);

}  // namespace mjdiag
