#pragma once
// The columns of a balance of forces (force_model.h): what every number in doubt and every
// trial of every law does along a motion, low-passed as the motion was.

#include <Eigen/Core>
#include <functional>
#include <set>
#include <vector>

#include "mjdiag/comparison/force_balance.h"
#include "mjdiag/discovery/forces/force_model.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/discovery/screening/trial.h"

namespace mjdiag {

/// A trial of a candidate, with its columns.
struct ForceTrial {
  std::size_t candidate = 0;
  std::function<TrialValues(const Amplitudes&)> values;
  std::set<Eigen::Index>
      joints;  ///< on which its force acts, places in ForceRows::dofs
  ForceGroup group;
};

class ForceColumns {
 public:
  /// @param problem   with the numbers in doubt
  /// @param filtered  its run
  /// @param balance   of the plant as it is given, along it
  ForceColumns(const DiscoveryProblem& problem, const FilteredRun& filtered,
               const ForceBalance& balance);

  /// What is missing, and what the numbers do, near those of the plant.
  ForceProblem NumbersAlone() const;
  /// Silences what joints say where they stick with the numbers of a fit, too.
  /// NumericalError if the plant cannot be there.
  void SilenceAt(const Eigen::VectorXd& z, ForceProblem& forces) const;
  /// z of a balance of forces, by factors, as z of the numbers in doubt.
  Eigen::VectorXd NumbersOf(const Eigen::VectorXd& z) const;
  /// Of all candidates that a balance of forces can tell, in their order.
  std::vector<ForceTrial> TrialsOf(const std::vector<Candidate>& candidates) const;

 private:
  Eigen::MatrixXd ForceOf(const DoubtedNumber& doubted) const;
  bool IsTold(const Candidate& candidate) const;
  std::vector<Trial> Within(const Candidate& candidate) const;
  Eigen::MatrixXd Of(const Trial& trial) const;
  std::set<Eigen::Index> JointsOf(const Eigen::MatrixXd& columns) const;

  const DiscoveryProblem& problem_;
  const FilteredRun& filtered_;
  const ObservedMotion motion_;
  const ObservedMotion of_laws_;       // with inputs as they were measured
  const Eigen::VectorXd missing_rms_;  // without the plant's friction, of every joint
  ForceRows rows_;
  const Eigen::VectorXd missing_;  // in rows
};

}  // namespace mjdiag
