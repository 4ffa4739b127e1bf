#include "mjdiag/signals/encoder_step.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace mjdiag {

double EncoderStep(const Eigen::VectorXd& x) {
  using Eigen::Index;
  constexpr std::size_t kLeast = 5;
  constexpr double kNear = 0.05;  // of a step
  constexpr double kMost = 3.0;   // steps at once
  constexpr double kShare = 0.5;
  std::vector<double> steps;
  std::optional<double> last;
  for (Index k = 0; k + 1 < x.size(); ++k) {
    if (x[k + 1] != x[k] || x[k] == last) continue;
    if (last) steps.push_back(std::abs(x[k] - *last));
    last = x[k];
  }
  if (steps.size() < kLeast) return 0.0;
  std::ranges::sort(steps);
  const double q = steps[steps.size() / 4];
  const auto multiples = std::ranges::count_if(steps, [&](double step) {
    const double times = std::round(step / q);
    return times >= 1.0 && times <= kMost && std::abs(step / q - times) < kNear;
  });
  const auto all = static_cast<double>(steps.size());
  return static_cast<double>(multiples) >= kShare * all ? q : 0.0;
}

}  // namespace mjdiag
