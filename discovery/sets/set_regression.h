#pragma once
// Sets of causes to add to a model, by one regression: all candidates with all their trials
// (trial.h), the numbers in doubt and the causes that the model has compete for what it
// leaves behind one observer, to first order along the motion as that observer has it.
// Held on the measured motion the first order is right however large an effect is. With
// the columns orthogonal to what the model can do by itself every set costs a small system,
//
//   G a = b,  G = Phi^T Phi,  b = Phi^T r,    gain = 2 b^T a - a^T G a
//
// of which G and b of all columns are made once. Sets grow in a beam, by the deviance that
// they leave and what is known of them beforehand,
//
//   D = |r|^2 - gain + sum of (a / s)^2 + ln(1 + G_ii a_i^2) - 2 ln(kMissing odds) + 2 ln T
//
// s the spread of a size, T how many trials its candidate has: the logarithms are those of
// the volume that a fit takes up of what was possible (Laplace's approximation).

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/fitting/cause_fit.h"

namespace mjdiag {

/// A set beside the causes that a model has, with first values of all.
struct ProposedSet {
  FittedModel model;
  double gain = 0.0;  ///< by which D is less than without it
};

/// @param problem     behind the observer that the model deserves
/// @param present     the model, and
/// @param jacobian    that of its numbers and causes behind the observer, train part; may be
///                    empty
/// @param most        sets of every size
/// The smallest first: the grid of a law's shape may leave more than three wrong laws
/// together, and only a fit can tell. Without those that add nothing to a smaller one as
/// far as the first order can tell. With numbers in doubt the model itself with better
/// ones is the first, its gain 0.
std::vector<ProposedSet> ProposeSets(const DiscoveryProblem& problem,
                                     const std::vector<Candidate>& candidates,
                                     const FittedModel& present,
                                     const Eigen::MatrixXd& jacobian, int most);

}  // namespace mjdiag
