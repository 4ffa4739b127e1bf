#pragma once
// What a recorded input does between its samples (Hold), as the physics steps of a tick
// see it. A step of h has one value, that of the middle of the step, which is the mean
// over the step up to h^2: with n steps a tick and samples u_k,
//   linear        u_k + (u_{k+1} - u_k) (i + 1/2) / n,  i = 0 .. n - 1
//   band-limited  sum over m of u_{k+m} s((i + 1/2) / n - m),  s(x) = sinc(x) w(x)
// with a Hann window w that is 0 from 16 samples on. Beyond its ends a record is held.

#include <Eigen/Core>
#include <algorithm>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

class InputCourse {
 public:
  /// Held.
  InputCourse() = default;
  InputCourse(Hold hold, const Eigen::VectorXd& samples, int substeps);

  /// The input in a physics step of a tick, above its sample of that tick.
  double Above(Eigen::Index tick, int substep) const noexcept {
    if (above_.size() == 0) return 0.0;
    return above_(substep, std::min(tick, above_.cols() - 1));
  }

 private:
  Eigen::MatrixXd above_;  // substeps x samples; empty: held
};

}  // namespace mjdiag
