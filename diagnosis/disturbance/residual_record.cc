#include "mjdiag/diagnosis/disturbance/residual_record.h"

#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {

void RequireRecord(const Eigen::VectorXd& residual, double sample_time,
                   Eigen::Index samples) {
  if (!(sample_time > 0.0)) {
    throw InputError("disturbance residual",
                     "sample time " + std::to_string(sample_time) + " s",
                     "a positive time");
  }
  if (residual.size() < samples) {
    throw InputError("disturbance residual",
                     "a record of " + std::to_string(residual.size()) + " samples",
                     "at least " + std::to_string(samples));
  }
  if (!residual.allFinite()) {
    throw InputError("disturbance residual", "a value that is not finite",
                     "finite values");
  }
}

}  // namespace mjdiag
