#include "mjdiag/controllers/reference.h"

#include <algorithm>

#include "mjdiag/signals/error.h"

namespace mjdiag {

AxisReference DifferentiateReference(const std::string& axis,
                                     const Eigen::VectorXd& position,
                                     double sample_time) {
  if (!(sample_time > 0.0)) {
    throw InputError("reference of axis '" + axis + "'", "sample time is not positive",
                     "seconds > 0");
  }
  const Eigen::Index n = position.size();
  AxisReference reference{axis, position, Eigen::VectorXd(n), Eigen::VectorXd(n),
                          Eigen::VectorXd(n)};
  const double rate = 1.0 / sample_time;
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = [&](Eigen::Index shift) {
      return position[std::clamp<Eigen::Index>(k + shift, 0, n - 1)];
    };
    const double second = at(1) - 2 * at(0) + at(-1);
    const double fourth = at(2) - 4 * at(1) + 6 * at(0) - 4 * at(-1) + at(-2);
    reference.velocity[k] = 0.5 * (at(1) - at(-1)) * rate;
    reference.acceleration[k] = second * rate * rate;
    reference.snap[k] = fourth * rate * rate * rate * rate;
  }
  return reference;
}

}  // namespace mjdiag
