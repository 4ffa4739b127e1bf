#include "mjdiag/signals/butterworth.h"

#include <cmath>
#include <numbers>
#include <string>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using std::numbers::pi;

constexpr int kMaxOrder = 20;

void RequireOrder(int order) {
  if (order >= 1 && order <= kMaxOrder) return;
  throw InputError("Butterworth filter", "order " + std::to_string(order),
                   "1 to " + std::to_string(kMaxOrder));
}

// In the sections, K = tan(pi fc T) is the prewarped cut-off in the unit of the
// bilinear transform, s / wc = (1 / K) (1 - z^-1) / (1 + z^-1).

/// 1 / (s + 1) or s / (s + 1)
SecondOrderSection FirstOrder(FilterKind kind, double K) {
  const double scale = 1.0 / (1.0 + K);
  const double feedback = (K - 1.0) * scale;
  if (kind == FilterKind::kLowPass) return {K * scale, K * scale, 0.0, feedback, 0.0};
  return {scale, -scale, 0.0, feedback, 0.0};
}

/// 1 / (s^2 + c s + 1) or s^2 / (s^2 + c s + 1)
SecondOrderSection SecondOrder(FilterKind kind, double c, double K) {
  const double scale = 1.0 / (1.0 + c * K + K * K);
  const double a1 = 2.0 * (K * K - 1.0) * scale;
  const double a2 = (1.0 - c * K + K * K) * scale;
  if (kind == FilterKind::kLowPass) {
    const double b = K * K * scale;
    return {b, 2.0 * b, b, a1, a2};
  }
  return {scale, -2.0 * scale, scale, a1, a2};
}

}  // namespace

TransferFunction ContinuousButterworth(FilterKind kind, int order, double cutoff) {
  RequireOrder(order);
  if (!(cutoff > 0.0) || !std::isfinite(cutoff)) {
    throw InputError("Butterworth filter",
                     "cut-off frequency " + std::to_string(cutoff) + " Hz",
                     "a positive frequency");
  }
  const double wc = 2.0 * pi * cutoff;
  const double angle = pi / (2.0 * order);
  Eigen::VectorXd normalised = Eigen::VectorXd::Ones(order + 1);
  // The polynomial is symmetric: the upper half is the lower half, not more rounding.
  for (int k = 1; k <= order / 2; ++k) {
    normalised[k] = normalised[k - 1] * std::cos((k - 1) * angle) / std::sin(k * angle);
    normalised[order - k] = normalised[k];
  }
  TransferFunction filter{Eigen::VectorXd::Zero(order + 1), Eigen::VectorXd(order + 1)};
  for (int k = 0; k <= order; ++k) {
    filter.denominator[k] = normalised[k] * std::pow(wc, k);
  }
  if (kind == FilterKind::kLowPass) {
    filter.numerator[order] = filter.denominator[order];
  } else {
    filter.numerator[0] = 1.0;
  }
  return filter;
}

SecondOrderSections DigitalButterworth(FilterKind kind, int order, double cutoff,
                                       double sample_time) {
  RequireOrder(order);
  if (!(sample_time > 0.0) || !(cutoff > 0.0) || !(cutoff * sample_time < 0.5)) {
    throw InputError("Butterworth filter",
                     "cut-off frequency " + std::to_string(cutoff) +
                         " Hz at sample time " + std::to_string(sample_time) + " s",
                     "a frequency between 0 and half the sampling rate");
  }
  const double K = std::tan(pi * cutoff * sample_time);
  SecondOrderSections sections;
  if (order % 2 == 1) sections.push_back(FirstOrder(kind, K));
  for (int pair = order / 2; pair >= 1; --pair) {
    const double damping = 2.0 * std::sin((2 * pair - 1) * pi / (2.0 * order));
    sections.push_back(SecondOrder(kind, damping, K));
  }
  return sections;
}

}  // namespace mjdiag
