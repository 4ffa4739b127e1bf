#pragma once
// Which of several faults are there, by a criterion on all of them together. With the
// estimate d of their deviations from healthy and its covariance C, the data fit worse
// without those of a set B by
//
//   d_B^T (C_BB)^-1 d_B
//
// chi-squared with as many degrees of freedom as B has unknowns if B is healthy. The
// faults that are named are those whose price is worth paying: the set that minimises
// what the others cost plus a price a fault, the quantile of chi-squared that a healthy
// one exceeds with the probability asked for. Judged one by one, by their marginal
// intervals, faults that are alike would hide each other.

#include <Eigen/Core>
#include <vector>

namespace mjdiag {

/// Probability that a fault is named on a healthy machine: in a run that is judged at its
/// end, or in the course of a day that it is watched.
inline constexpr double kFalseFault = 1e-4;

/// @param deviations     d, p
/// @param covariance     C, p x p
/// @param groups         of unknowns, one group a fault
/// @param false_naming   probability that anything is named on a healthy machine
/// @return for each group whether it is named
std::vector<bool> NameFaults(const Eigen::VectorXd& deviations,
                             const Eigen::MatrixXd& covariance,
                             const std::vector<std::vector<Eigen::Index>>& groups,
                             double false_naming);

}  // namespace mjdiag
