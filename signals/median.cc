#include "mjdiag/signals/median.h"

#include <algorithm>

namespace mjdiag {

double Median(Eigen::VectorXd values) {
  double* middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

}  // namespace mjdiag
