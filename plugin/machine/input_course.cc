#include "mjdiag/plugin/machine/input_course.h"

#include <cmath>
#include <numbers>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kReach = 16;  // of the window [samples]

double WindowedSinc(double x) {
  const double angle = std::numbers::pi * x;
  const double window = std::cos(angle / (2.0 * kReach));
  return angle == 0.0 ? 1.0 : std::sin(angle) / angle * window * window;
}

/// Weights of the samples from kReach - 1 before to kReach after, for a place between
/// two samples. They add up to 1, so that a constant stays one.
VectorXd Weights(Hold hold, double place) {
  VectorXd weights = VectorXd::Zero(2 * kReach);
  if (hold == Hold::kLinear) {
    weights[kReach - 1] = 1.0 - place;
    weights[kReach] = place;
    return weights;
  }
  for (Index i = 0; i < weights.size(); ++i) {
    weights[i] = WindowedSinc(place - static_cast<double>(i - kReach + 1));
  }
  return weights / weights.sum();
}

}  // namespace

InputCourse::InputCourse(Hold hold, const VectorXd& samples, int substeps) {
  if (hold == Hold::kZero) return;
  const Index n = samples.size();
  above_.resize(substeps, n);
  VectorXd around(2 * kReach);
  for (int i = 0; i < substeps; ++i) {
    const VectorXd weights = Weights(hold, (i + 0.5) / substeps);
    for (Index k = 0; k < n; ++k) {
      for (Index j = 0; j < around.size(); ++j) {
        around[j] = samples[std::clamp<Index>(k + j - kReach + 1, 0, n - 1)];
      }
      above_(i, k) = weights.dot(around) - samples[k];
    }
  }
}

}  // namespace mjdiag
