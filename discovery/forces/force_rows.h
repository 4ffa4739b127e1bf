#pragma once
// Forces along a motion as the rows of a regression: of every joint that has one, values
// that are half a period of their band apart, one joint after the other. What is closer
// tells nothing new.
//
// What a model lacks besides the laws that are fitted is noise of the model: a latent force
// at every joint, of unknown size and time constant (maximum likelihood of a stochastic
// grey-box model [Kristensen 2004]). In the rows of joint j
//
//   r[k] = phi_j r[k-1] + s_j e[k],   e white of variance 1,
//
// so that e = (r[k] - phi_j r[k-1]) / s_j are the independent values, and
//
//   -2 ln L = sum over joints of n_j (ln s_j^2 + 1),   s_j^2 = mean (r[k] - phi_j r[k-1])^2.
//
// Where a joint's own dry friction is below its bound it takes what is missing, and the joint
// says nothing: such rows are silent, and the next one begins anew.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/comparison/force_balance.h"

namespace mjdiag {

/// Which values the rows are.
struct ForceRows {
  std::vector<Eigen::Index> dofs;
  std::vector<Eigen::Index> samples;  ///< of every value of a joint
  Eigen::Index step = 1;              ///< between two values that follow each other
  std::vector<bool> begins;           ///< whether a value does not follow the last one
  Eigen::Index train = 0;             ///< values of a joint that a fit sees, the first
  /// Of every row, whether it says nothing: the joint's own dry friction takes there what is
  /// missing. Empty: all say something.
  std::vector<bool> silent;

  bool IsSilent(Eigen::Index row) const {
    return !silent.empty() && silent[static_cast<std::size_t>(row)];
  }
  /// Whether a row does not follow the last one.
  bool Begins(Eigen::Index joint, Eigen::Index value) const {
    return begins[static_cast<std::size_t>(value)] ||
           IsSilent(joint * values() + value - 1);
  }

  Eigen::Index values() const { return static_cast<Eigen::Index>(samples.size()); }
  Eigen::Index rows() const {
    return values() * static_cast<Eigen::Index>(dofs.size());
  }
};

/// @param train  samples of the run that a fit sees
ForceRows RowsAlong(const FilteredRun& filtered, std::vector<Eigen::Index> dofs,
                    Eigen::Index train);

/// Rows near samples at which a joint sticks are silent; none of a joint that would be left
/// with next to nothing. @param sticks  nv x samples
void Silence(const JointMask& sticks, ForceRows& rows);

/// The rows of forces that are within the band. @param forces  nv x samples
Eigen::VectorXd RowsOf(const ForceRows& rows, const Eigen::MatrixXd& forces);

/// The noise of the model.
struct ForceNoise {
  Eigen::VectorXd phi;
  Eigen::VectorXd sd;  ///< s [N, N m]
};

/// Of what is left, in the values of `seen` (of every joint the same).
ForceNoise NoiseOf(const ForceRows& rows, const Eigen::VectorXd& left,
                   const std::vector<bool>& seen);
/// Of the same variance, each value independent of the last.
ForceNoise WithoutMemory(ForceNoise noise);
/// Rows over the noise, each column.
Eigen::MatrixXd Whitened(const ForceRows& rows, const ForceNoise& noise,
                         const Eigen::MatrixXd& columns);
/// -2 ln L without its constants.
double DevianceOf(const ForceRows& rows, const ForceNoise& noise,
                  const std::vector<bool>& seen);

}  // namespace mjdiag
