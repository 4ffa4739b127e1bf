#pragma once
// The forces that a machine lacks along a run, smoothed (force_smoother.h), as rows of a
// regression: each joint's in means over 20 ms, over its own size; a column is the force that
// it is there. It is the regression of identification by inverse dynamics [Gautier, Khalil
// 1990]: the motion is taken as it was measured, so that feedback, which makes inputs follow
// what is missing, biases nothing; and what is missing counts by its size, however slow it
// is, where innovations behind a latent force that lasts see only its changes. What is left
// lasts: rows count once in the time over which they repeat themselves (R. Geyer, "Practical
// Markov Chain Monte Carlo", Statist. Sci. 7, 1992: the initial positive sequence).
//
// A reading that is off makes a motion that was not, and a force for it: with what positions
// that read so are off by, dq = C^+ dy, and dv = dq' beside them,
//
//   f[k] = B^+ (dx[k + 1] - A dx[k]),     dx = [dq; dv].

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/regression/row_map.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// Positions that readings tell, C^+ behind their noises, nv x ny.
Eigen::MatrixXd PositionOfReadings(const FilterPath& path);

/// What all maps of a path share: they differ in how large the rest is.
struct DisturbanceRows {
  struct Window {
    Eigen::Index first = 0;
    Eigen::Index count = 0;
  };
  /// @param path     has to outlive it
  /// @param missing  of all latent forces, nf x samples
  DisturbanceRows(const FilterPath& path, const Eigen::MatrixXd& missing);
  /// Means of forces in every window, window by window.
  Eigen::VectorXd Means(const Eigen::MatrixXd& forces) const;

  const FilterPath& path;
  std::vector<Window> windows;
  Eigen::VectorXd missing;
  /// Of every tangent, latent forces that do a change of the state in a tick, nf x ns.
  std::vector<Eigen::MatrixXd> force_of_change;
  Eigen::MatrixXd position_of_readings;  ///< PositionOfReadings
};

class DisturbanceMap final : public RowMap {
 public:
  /// How large what is left is of every latent force, and over how many rows it repeats
  /// itself.
  struct Rest {
    Eigen::VectorXd sd;
    Eigen::VectorXd repeats;
  };

  /// @param of  has to outlive it
  DisturbanceMap(const DisturbanceRows& of, const Rest& rest);
  /// Rest of all that is missing.
  static Rest RestOf(const DisturbanceRows& of);
  /// Of what is left of it in the rows of this.
  Rest RestOf(const Eigen::VectorXd& left) const;

  Eigen::Index rows() const override { return left_.size(); }
  const Eigen::VectorXd& left() const override { return left_; }
  double log_determinant() const override;
  Eigen::MatrixXd Of(const std::vector<const Column*>& columns) const override;
  std::vector<Transposed> TransposedTimes(const Eigen::MatrixXd& u) const override;

 private:
  /// Forces for errors of readings. @param errors  ny x samples  @return nf x samples
  Eigen::MatrixXd ForcesOfErrors(const Eigen::MatrixXd& errors) const;
  /// The adjoint. @param forces  nf x samples  @return ny x samples
  Eigen::MatrixXd ErrorsOfForces(const Eigen::MatrixXd& forces) const;

  const DisturbanceRows& of_;
  Rest rest_;
  Eigen::VectorXd weight_;  // nf
  Eigen::VectorXd left_;
};

}  // namespace mjdiag
