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

#include "mjdiag/discovery/regression/row_map.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/kept_gains.h"

namespace mjdiag {

/// W times every column, rows x columns.
Eigen::MatrixXd WhitenedAlong(const FilterPath& path, const KeptGains& gains,
                              const std::vector<const Column*>& columns);

class Whitening final : public RowMap {
 public:
  /// @param path  has to outlive it
  Whitening(const FilterPath& path, KeptGains gains);

  const KeptGains& gains() const { return gains_; }
  Eigen::Index rows() const override { return gains_.rows(); }
  const Eigen::VectorXd& left() const override { return gains_.left; }
  double log_determinant() const override { return gains_.log_determinant; }
  Eigen::MatrixXd Of(const std::vector<const Column*>& columns) const override {
    return WhitenedAlong(path_, gains_, columns);
  }

  std::vector<Transposed> TransposedTimes(const Eigen::MatrixXd& u) const override;

 private:
  const FilterPath& path_;
  KeptGains gains_;
};

}  // namespace mjdiag
