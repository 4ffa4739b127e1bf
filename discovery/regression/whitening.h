#pragma once
// The filter of a path behind a noise as a linear operator W on columns: what a force f of
// the machine, a change x of its state or an error h of a reading, that the filter does not
// know of would leave in its innovations, over their standard deviations,
//
//   d <- d - K (c^T d + h)            through a reading, d truth less estimate,
//   (W f)_r = (c^T d + h) / sqrt(S)   of the reading r,
//   d <- A d + B f + x                through a tick.
//
// The innovations themselves, whitened, are W times what is missing plus white noise of
// variance 1.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/kept_gains.h"

namespace mjdiag {

class Whitening {
 public:
  /// @param path  has to outlive it
  Whitening(const FilterPath& path, KeptGains gains);

  const KeptGains& gains() const { return gains_; }
  Eigen::Index rows() const { return gains_.rows(); }

  /// W times every column, rows x columns.
  Eigen::MatrixXd Of(const std::vector<const Column*>& columns) const;

  /// W^T u: the inner product of u with W times a column of forces and errors of readings
  /// is that of this with the column.
  struct Transposed {
    Eigen::MatrixXd forces;    ///< samples x nv
    Eigen::MatrixXd readings;  ///< samples x ny
    /// What of the inner product with a column comes from every sample.
    Eigen::VectorXd Along(const Column& column) const;
    double Times(const Column& column) const;
  };
  /// Of every column of u, rows x any.
  std::vector<Transposed> TransposedTimes(const Eigen::MatrixXd& u) const;

 private:
  void ForwardInto(const std::vector<const Column*>& columns, Eigen::Index first,
                   Eigen::Index count, Eigen::MatrixXd& out) const;

  const FilterPath& path_;
  KeptGains gains_;
};

}  // namespace mjdiag
