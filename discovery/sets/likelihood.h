#pragma once
// How probable a record is beside a model that lacks something. What a model lacks is noise
// of it, a white force at every driven joint, and how much of that there is nobody knows
// beforehand: it is one more unknown. Behind the Kalman predictor of that noise
// (observer.h),
//
//   -2 ln L = sum over ticks and sensors of ln S_ii / r_i^2 + e_i^2 / S_ii,
//
// S = C P C^T + R the covariance of the innovations e, r_i the noise of sensor i (the
// sensors as if they were independent of each other). Slow observers, which take the model
// for true, are the sensitive ones; beside a model that is wrong they have innovations that
// their S does not allow. The most likely noise is as large as what the model lacks, and the
// observer that goes with it as fast as the model is wrong. It orders nothing, half truths
// and truths without any constant [Kristensen 2004].

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/hypotheses/fitted_model.h"
#include "mjdiag/discovery/hypotheses/problem.h"

namespace mjdiag {

/// Observers of one record from the fastest, which holds the model on the measured motion
/// whatever it lacks, to the one of the problem, by steps of 3 in bandwidth. Their residuals
/// are innovations over the root of S_ii.
class ObserverLadder {
 public:
  /// The numbers of the problem are in doubt behind all of them.
  explicit ObserverLadder(const DiscoveryProblem& problem);

  /// Of the same machine in that many physics steps a tick, which are late by less.
  ObserverLadder WithSubsteps(int substeps) const;

  std::size_t size() const { return problems_.size(); }
  const DiscoveryProblem& operator[](std::size_t rung) const { return problems_[rung]; }
  double bandwidth(std::size_t rung) const { return bandwidths_[rung]; }

  /// -2 ln L of what fits see, from the residual behind that observer.
  double Deviance(std::size_t rung, const Eigen::VectorXd& residual) const;
  /// The same of the rest of the record.
  double HeldOut(std::size_t rung, const Eigen::VectorXd& residual) const;
  /// The least that it may be: of sensor noise alone beside a model that is true.
  double Noise() const { return noise_; }

 private:
  double Deviance(std::size_t rung, const Eigen::VectorXd& residual, Eigen::Index first,
                  Eigen::Index last) const;

  std::vector<double> bandwidths_;
  std::vector<DiscoveryProblem> problems_;
  std::vector<Eigen::VectorXd> logarithms_;  // ln S_ii / r_i^2
  double noise_ = 0.0;
};

}  // namespace mjdiag
