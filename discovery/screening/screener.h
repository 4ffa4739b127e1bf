#pragma once
// One screening: what there is to explain, and what trials (trial.h) and sweeps of them
// gain of it (screening.h).

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/screening/trial.h"
#include "mjdiag/plugin/replay/error_dynamics.h"

namespace mjdiag {

/// What a screening works on: the samples of `problem` that are for fits.
class Screener {
 public:
  /// @param dynamics     of the samples of the problem that are for fits, in blocks
  /// @param residual     scaled innovations
  /// @param jacobian     J of what has been found; may be empty
  /// @param present      what has been found: J has its numbers first
  Screener(const DiscoveryProblem& problem, const ErrorDynamics& dynamics,
           const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian,
           const FittedModel& present);

  /// Squared residual, as far as what has been found cannot take it away.
  double Rest() const { return rest_; }
  /// The start that every trial of one candidate gives; those that are not physical or
  /// do not show give none.
  std::vector<std::optional<Start>> Judge(const std::vector<Trial>& trials,
                                          const Candidate& candidate) const;
  /// The trials of a sweep that promise most, and neighbours of them.
  /// @param worth  of its values, larger is better
  std::vector<Trial> BestOf(const Sweep& sweep, const Candidate& candidate,
                            const std::vector<double>& worth) const;
  /// About what every value of a sweep gains. What a wave has in common with the
  /// residual comes from the adjoint, one product each; its size, which is nearly
  /// smooth over the sweep, from a few of them.
  std::vector<double> RoughGains(const Sweep& sweep, const Candidate& candidate) const;
  /// The tops of the `count` peaks of a sweep that look highest.
  std::vector<double> Peaks(const Sweep& sweep, const Candidate& candidate,
                            std::size_t count) const;
  /// The value at a place, a number or between two.
  static double ValueAt(const Sweep& sweep, double place);

 private:
  /// What places of a sweep gain: numbers of its values, and between them.
  std::vector<double> Gains(const Sweep& sweep, const Candidate& candidate,
                            const std::vector<double>& places) const;
  std::vector<double> BestPlaces(const Sweep& sweep, const std::vector<double>& places,
                                 const Candidate& candidate, std::size_t count) const;
  /// take(t, response of trial t, whether that is fast) for all trials in order, filtered
  /// many at a time.
  template <typename Take>
  void ForEachResponse(const std::vector<Trial>& trials, const Candidate& candidate,
                       const Take& take) const;
  void Charge(Eigen::Index numbers, Eigen::Index count) const;
  /// Whether a trial is an error of readings that is too fast for the means of blocks: no
  /// observer follows it, and it shows in the innovations as it is.
  bool IsFast(const Trial& trial) const;
  /// How many values of a sweep, from the first on, make trials that are not.
  std::size_t Slow(const Sweep& sweep) const;
  Eigen::MatrixXd Fast(const Trial& trial, const Candidate& candidate) const;
  std::vector<double> Common(const Sweep& sweep, const Candidate& candidate) const;
  Eigen::MatrixXd Responses(const std::vector<Trial>& trials, std::size_t first,
                            std::size_t last, const Candidate& candidate) const;
  std::optional<Start> Regress(const Trial& trial, const Eigen::MatrixXd& response,
                               const Eigen::VectorXd& residual, bool fast) const;

  const DiscoveryProblem& problem_;
  const ErrorDynamics& dynamics_;
  Eigen::Index channels_;
  Eigen::Index block_;    // samples
  Eigen::Index skip_;     // blocks
  Eigen::Index blocks_;   // after them
  Eigen::VectorXd full_;  // residual of every sample
  double rest_ = 0.0;
  Eigen::VectorXd residual_;        // of every block, then of the numbers
  Eigen::MatrixXd found_;           // orthonormal, the same rows
  ErrorDynamics::Adjoint adjoint_;  // of residual_, blocks from the start on
};

}  // namespace mjdiag
