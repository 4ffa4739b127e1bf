#pragma once
// What a better model is for: how small a fault can be seen on the measured machine.
// The response phi of the innovations to a fault parameter is known to first order
// (trial.h). A healthy machine whose model is wrong already looks like a fault of size
//
//   theta = phi^T e / phi^T phi,
//
// and differently so from one part of the record to the next. A fault that is smaller
// than |theta| + 3 sd(theta), sd from the parts, is hidden by that.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// |theta| + 3 sd(theta).
/// @param phi  response of innovations to a change of the fault parameter by 1
double HiddenFault(const Eigen::VectorXd& phi, const Eigen::VectorXd& innovations);

/// Fault parameter -> limit, as a change of it. @param changes  to the model
std::map<std::string, double> FaultLimits(const DiscoveryProblem& problem,
                                          const std::vector<Candidate>& candidates,
                                          const Changes& changes);

}  // namespace mjdiag
