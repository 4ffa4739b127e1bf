#pragma once
// What no record of motion tells: a machine with all its masses, springs, dampers, frictions
// and motors s times as large moves the same. Along
//
//   d z_i / d ln s = 1 / spread_i               of every number of the plant
//   d theta_j / d ln s = n_j theta_j            of a parameter in units of force^n
//
// J has to be nothing. A first order that is off by a part in a thousand says otherwise, and
// beside a rest far above noise says it with many standard deviations: fits would go wherever
// that leads them, and intervals would be as narrow as it claims. J is made to say nothing
// there; what is known beforehand decides. A direction of that kind is there for every part
// of the plant that nothing joins to the rest, if all of its numbers are in doubt.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// n of a unit: 1 of "N s/m" and "kg", -1 of "1/N/m", 0 of "m".
int ForceExponent(const std::string& unit);

/// Columns d theta / d ln s, theta = (z, parameters of the causes).
Eigen::MatrixXd ScaleGauges(const DiscoveryProblem& problem,
                            const std::vector<Candidate>& candidates,
                            const std::vector<FittedCause>& causes,
                            const Eigen::VectorXd& theta);

/// Takes out of J what it says along those columns, as far as it is no more than first
/// orders are off by; of the largest columns most.
void RemoveGauges(const Eigen::MatrixXd& gauges, Eigen::MatrixXd& jacobian);

}  // namespace mjdiag
