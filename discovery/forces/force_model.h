#pragma once
// One regression of all that a plant lacks along a motion (force_rows.h):
//
//   F = N z + sum over laws of Phi_i a_i + noise of the model,   z ~ N(0, 1)
//
// N: what the numbers of the plant in doubt do (number_forces.h), z in what is known of
// them; Phi_i: the forces of a law at its site with amplitudes a_i, which may have lower
// bounds. Everything is linear in forces along the motion, however large an effect is.
// Generalised least squares, the noise found beside it.
//
// What scales a drive scales its input, which was measured with what no model explains.
// With g the factors of the drives, of which the first order is among the columns, what is
// left is in units of the input,
//
//   r = (F - N z - sum of Phi_i a_i) / g,
//
// or a joint that weighs next to nothing would be explained by a motor that does nothing.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mjdiag/discovery/forces/force_rows.h"

namespace mjdiag {

/// Columns of a trial of a law.
struct ForceGroup {
  Eigen::MatrixXd columns;  ///< rows x amplitudes
  Eigen::VectorXd least;    ///< of every amplitude; empty: anything
  bool scales_drive = false;
  /// What it costs to have it, in -2 ln L, besides what is known of its sizes.
  double cost = 0.0;
};

struct ForceProblem {
  ForceRows rows;
  Eigen::VectorXd missing;  ///< rows
  Eigen::MatrixXd numbers;  ///< rows x numbers
  Eigen::VectorXd drives;   ///< spread of every number that scales a drive, else 0
};

struct ForceFit {
  Eigen::VectorXd z;           ///< numbers
  Eigen::VectorXd amplitudes;  ///< of all groups, one after the other
  ForceNoise noise;
  /// -2 ln L + |z|^2 + parameters ln n + the cost of the groups; infinite where a bound is
  /// violated.
  double score = 0.0;
  Eigen::VectorXd left;  ///< rows
};

/// Of the values that a fit sees.
ForceFit FitForces(const ForceProblem& problem,
                   const std::vector<const ForceGroup*>& groups,
                   const ForceNoise& start);
/// The noise of the plant as it is given.
ForceNoise NoiseOfNothing(const ForceProblem& problem);

/// What the numbers take away of what a fit leaves, rows x numbers.
Eigen::MatrixXd NumbersBeside(const ForceProblem& problem,
                              const std::vector<const ForceGroup*>& groups,
                              const ForceFit& fit);

/// By how much less likely the values become that a fit did not see, without each of the
/// groups: what is seen is cut into five parts, each is predicted from the others. In -2 ln
/// L, with the noise as it is.
struct UnseenLoss {
  Eigen::VectorXd each;
  double all = 0.0;  ///< without all of them together
};
UnseenLoss LossUnseen(const ForceProblem& problem,
                      const std::vector<const ForceGroup*>& groups,
                      const ForceFit& fit);

/// What each of the groups would take away of what a fit leaves, beside all of the others,
/// less its cost; minus infinity where a bound would be violated.
Eigen::VectorXd GainsBeside(const ForceProblem& problem,
                            const std::vector<const ForceGroup*>& set,
                            const ForceFit& fit,
                            const std::vector<const ForceGroup*>& tried);

}  // namespace mjdiag
