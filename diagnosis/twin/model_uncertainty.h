#pragma once
// How far estimates of faults are off because the model is not the machine, learned from
// runs in which there were none. What is left beside such a model is alike from one tick
// to the next, and different from one stroke to another: it does not average out as noise
// does, and no covariance of noise covers it. Parts of the runs show it. With N_k the
// information of part k on the faults, all else unknown, and s_k = N_k d_k its score (d_k:
// what a diagnosis of that part would say),
//
//   N = P0^-1 + sum_k N_k,   S = N^-1 (sum_k s_k s_k^T) N^-1   K + 1 / (K - 1)
//
// is the covariance of what all K parts say together, whatever is in them ([White 1980],
// by parts instead of samples); noise alone would make it N^-1. The model is uncertain by
// what S has beyond that. Few parts tell few directions: S counts as n times its degrees
// of freedom, K - 1, beside N^-1 times the mean of its size in all p directions as p
// times. K is the effective number of parts, (sum_k w_k)^2 / sum_k w_k^2 with w_k their
// shares of the information.
//
// Runs that differ from each other by more than their parts do, each a motion of its own,
// add what the same sum over runs, K of them, has beyond that over parts.
//
// Of a run of another motion the model may be off by as much again as of one of these
// runs, and by more if it is shorter (Times). How motions differ that are not among these
// runs, nobody knows.
//
// [White 1980] H. White, A heteroskedasticity-consistent covariance matrix estimator and a
// direct test for heteroskedasticity, Econometrica 48, 1980.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/twin/run_pass.h"

namespace mjdiag {

struct ModelUncertainty {
  /// Of which unknowns, by name: fault parameters, sines and cosines of tones.
  std::vector<std::string> unknowns;
  /// Of what all the runs together say of them. Empty: the model is the machine.
  Eigen::MatrixXd covariance;
  double freedom = 0.0;   ///< degrees of freedom of that
  double duration = 0.0;  ///< of all the runs [s]
  int runs = 0;

  bool any() const { return covariance.size() > 0; }
  /// The covariance of an estimate from one run of another motion is so many times that:
  /// 1 for where healthy is, which ever more healthy runs would tell, the rest for the
  /// run itself. @param of_run  how long that is [s], > 0
  double Times(double of_run) const noexcept;
  /// How many times its standard deviation it exceeds with that probability, of either
  /// sign, over that of a normal distribution with another one: few parts may have shown
  /// too little. @param probability, normal  0 to 1
  double Stretch(double probability, double normal) const;

  bool operator==(const ModelUncertainty&) const = default;
};

/// @param runs     parts of each, about what all of them say together, n x n
/// @param prior    P0^-1 of all n unknowns, those of the calibration told by these runs
/// @param faults   places of those that are 0 in these runs
/// @param certain  whether it is certain that the model is not the machine: else it is
///                 taken for it where chance explains what the parts say
/// @return covariance and freedom
ModelUncertainty ScatterOfParts(const std::vector<std::vector<PartInformation>>& runs,
                                const Eigen::MatrixXd& prior,
                                const std::vector<Eigen::Index>& faults, bool certain);

}  // namespace mjdiag
