#pragma once
// What nobody would miss, however surely many samples tell it: forces that are no more at any
// joint than a hundredth of what all that is known does there, or than a tenth of what physics
// steps do that a record does not know, for steps are taken away to first order; and errors of
// readings that no single reading shows, where forces that would do as much are such, too.
//
//   f = sum_i a_i (f_i + M dv_i / h),      e = sum_i a_i e_i,
//   f_e = M q'' + D q' + K q,  q = C^+ e,
//
// f_i a column's forces, dv_i its changes of the velocities in a tick h, e_i its errors of
// readings, a_i amplitudes, rms along a path.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

using ScaledColumn = std::pair<double, const Column*>;

class Negligible {
 public:
  /// @param path        has to outlive it, as what is given as machine and noises
  /// @param reading_sd  of every sensor, by itself
  /// @param known       what all members do
  /// @param steps       what steps do that are not known; none: those of the record are
  Negligible(const Machine& machine, const FilterPath& path,
             const Eigen::VectorXd& reading_sd, const std::vector<ScaledColumn>& known,
             const Column* steps);

  bool IsForce(const std::vector<ScaledColumn>& columns) const;
  bool IsError(const std::vector<ScaledColumn>& columns) const;

 private:
  /// Also where nothing is measured, for a mount acts there. [N, N m]
  Eigen::VectorXd ForcesOf(const std::vector<ScaledColumn>& columns) const;

  const Machine& machine_;
  const FilterPath& path_;
  const Eigen::VectorXd& reading_sd_;
  Eigen::VectorXd least_;  ///< that would be missed, rms at the joints [N, N m]
};

}  // namespace mjdiag
