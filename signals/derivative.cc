#include "mjdiag/signals/derivative.h"

#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

Eigen::VectorXd CentralDifference(const Eigen::VectorXd& signal, double sample_time) {
  const Eigen::Index size = signal.size();
  if (size < 3) {
    throw InputError("derivative", "a signal of " + std::to_string(size) + " samples",
                     "at least three");
  }
  if (!(sample_time > 0.0)) {
    throw InputError("derivative", "sample time " + std::to_string(sample_time) + " s",
                     "a positive time");
  }
  const auto& x = signal;
  Eigen::VectorXd change(size);  // over two samples
  change.segment(1, size - 2) = x.tail(size - 2) - x.head(size - 2);
  change[0] = -3.0 * x[0] + 4.0 * x[1] - x[2];
  change[size - 1] = 3.0 * x[size - 1] - 4.0 * x[size - 2] + x[size - 3];
  return change / (2.0 * sample_time);
}

}  // namespace mjdiag
