#pragma once
// What no record of motion tells: a machine with all its masses, springs, dampers, frictions
// and motors s times as large moves the same. With t = ln s,
//
//   z_i += t / spread_i                          for every number of the plant
//   theta_j -> (theta_j + v_j) s^(n_j) - v_j     for a parameter in units of force^n that adds
//                                                to a number v, 0 if to none
//
// Along that J has to be nothing. A first order that is off by a part in ten thousand says
// otherwise, and beside 10^6 standard deviations says it with a hundred: fits would stay
// where that holds them, and intervals would be as narrow as it claims. J is made to say
// nothing there, and what is known beforehand decides where a fit ends. There is such a
// gauge for every part of the plant that nothing joins to the rest, if all of its numbers are
// in doubt, and one for every fault parameter beside the numbers that it scales.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// n of a unit: 1 of "N s/m" and "kg", -1 of "1/N/m", 0 of "m".
int ForceExponent(const std::string& unit);

struct ScaleGauge {
  Eigen::VectorXd shift;     ///< 1 / spread of numbers; 0 of parameters
  Eigen::VectorXd exponent;  ///< n
  Eigen::VectorXd offset;    ///< v

  /// d theta / dt.
  Eigen::VectorXd Along(const Eigen::VectorXd& theta) const;
  /// theta moved by t.
  Eigen::VectorXd Moved(const Eigen::VectorXd& theta, double t) const;
};

std::vector<ScaleGauge> ScaleGauges(const DiscoveryProblem& problem,
                                    const std::vector<Candidate>& candidates,
                                    const std::vector<FittedCause>& causes);

/// The model without a cause, with what it did in the numbers in doubt that it scales or adds
/// to: the same machine, if that is all that it does.
FittedModel HandedOver(const DiscoveryProblem& problem,
                       const std::vector<Candidate>& candidates,
                       const FittedModel& model, std::size_t cause);

/// Those along which J says no more than first orders are off by.
std::vector<ScaleGauge> Untold(std::vector<ScaleGauge> gauges,
                               const Eigen::VectorXd& theta,
                               const Eigen::MatrixXd& jacobian);

/// Takes out of J what it says along those directions G, J -= J G (G^T W G)^-1 G^T W with W
/// the squared norms of the columns of J: of the largest most.
void RemoveGauges(const std::vector<ScaleGauge>& gauges, const Eigen::VectorXd& theta,
                  Eigen::MatrixXd& jacobian);

/// theta moved along the gauges to where what is known beforehand is best kept,
///
///   min over t of  sum of ((theta_i - nothing_i) / spread_i)^2
///
/// as far as it stays within its bounds.
Eigen::VectorXd KeptToWhatIsKnown(const std::vector<ScaleGauge>& gauges,
                                  Eigen::VectorXd theta,
                                  const std::vector<FitParameter>& parameters);

}  // namespace mjdiag
