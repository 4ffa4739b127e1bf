#pragma once
// The filter of a path behind a noise (force_filter.h) as a linear operator W on columns:
// what a force f of the machine, or an error h of a reading, that the filter does not know
// of would leave in its innovations, over their standard deviations,
//
//   d <- d - K (c^T d + h)            through a reading, d truth less estimate,
//   (W f)_r = (c^T d + h) / sqrt(S)   of the reading r,
//   d <- A d + B f                    through a tick.
//
// The innovations themselves, whitened, are W times what is missing plus white noise of
// variance 1. A reading that is cut (Huber) weighs as it does behind the path's own noise,
// whatever noise is tried: sets behind different noises are compared on the same data.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// How many times its variance every reading has behind the path's own noise, ny x samples.
Eigen::MatrixXd InflationAlong(const FilterPath& path);

class Whitening {
 public:
  /// @param path  has to outlive it
  Whitening(const FilterPath& path, const FilterNoise& noise,
            const Eigen::MatrixXd& inflation);

  /// Readings that count, in the order in which they are taken.
  Eigen::Index rows() const { return left_.size(); }
  Eigen::Index SampleOf(Eigen::Index row) const {
    return readings_[static_cast<std::size_t>(row)].sample;
  }
  /// Innovations over their standard deviations, rows.
  const Eigen::VectorXd& left() const { return left_; }
  /// sum of ln S
  double log_determinant() const { return log_determinant_; }

  /// W times every column, rows x columns.
  Eigen::MatrixXd Of(const std::vector<const Column*>& columns) const;

  /// W^T u: the inner product of u with W times any column is that of this with the column.
  struct Transposed {
    Eigen::MatrixXd forces;    ///< nv x samples
    Eigen::MatrixXd readings;  ///< ny x samples
    double Times(const Column& column) const;
  };
  /// Of every column of u, rows x any.
  std::vector<Transposed> TransposedTimes(const Eigen::MatrixXd& u) const;

 private:
  struct Reading {
    Eigen::Index sensor = 0;
    Eigen::Index sample = 0;
    bool late = false;
  };
  /// Rows that are taken in a tick.
  struct Tick {
    Eigen::Index first = 0;
    Eigen::Index end = 0;
  };
  void ForwardInto(const std::vector<const Column*>& columns, Eigen::Index first,
                   Eigen::Index count, Eigen::MatrixXd& out) const;

  const FilterPath& path_;
  std::vector<Reading> readings_;
  std::vector<Tick> ticks_;
  Eigen::MatrixXd K_, C_;  // n x rows
  Eigen::VectorXd inverse_sd_;
  Eigen::VectorXd left_;
  Eigen::VectorXd rho_;
  double log_determinant_ = 0.0;
};

}  // namespace mjdiag
