#pragma once
// The search for what a machine lacks that leaves its rest, along its measured motion: a
// set of laws beside the numbers in doubt, by the likelihood with the noise of the model
// among its unknowns (force_model.h). Candidates with all their trials are columns, made
// once. Then
//
//   add       the trial that makes the record likelier than any other, as long as one does;
//   exchange  each law for any other trial at its place, and leave out what is not needed,
//             until nothing changes; then add again;
//   unseen    drop laws without which what a fit did not see is predicted as well.
//
// -2 ln L has besides ln n a parameter: what is known of sizes beforehand, -2 ln(kMissing
// odds) of the law and 2 ln of how many trials its candidate has.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/forces/force_model.h"

namespace mjdiag {

/// A candidate in the place of a law, with the score that the set has then.
struct ForceRival {
  FittedCause cause;
  double score = 0.0;
};

struct ForceSearchResult {
  FittedModel model;  ///< laws in the order in which they were found, and the numbers
  Eigen::VectorXd numbers_alone;
  /// Of every law, itself first: those that could be in its place.
  std::vector<std::vector<ForceRival>> rivals;
  /// By how much less likely unseen motion is without each law, in -2 ln L.
  Eigen::VectorXd loss;
  double loss_of_all = 0.0;  ///< without any
  ForceRows rows;
  ForceNoise noise;         ///< that the set leaves
  Eigen::MatrixXd numbers;  ///< columns of the numbers, rows x numbers

  /// Of the squares that unseen motion leaves without any law, in units of the noise that
  /// the laws leave, the part that they take away.
  double ExplainedUnseen() const;
};

struct ForceSearchOptions {
  int most_causes_a_joint = 8;
  /// What is tried, which share is done, and the laws so far. May be empty.
  std::function<void(const std::string& what, double fraction,
                     const std::vector<FittedCause>& causes)>
      progress;
};

/// @param problem   with the numbers in doubt
/// @param filtered  its run
/// @param balance   of the plant as it is given, along it
ForceSearchResult SearchForces(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const FilteredRun& filtered, const ForceBalance& balance,
                               const ForceSearchOptions& options);

}  // namespace mjdiag
