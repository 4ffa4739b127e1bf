#include "mjdiag/diagnosis/disturbance/tone_magnitude.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <unsupported/Eigen/SpecialFunctions>

#include "mjdiag/diagnosis/disturbance/residual_record.h"
#include "mjdiag/diagnosis/disturbance/sine_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

void RequireResolved(VectorXd frequency, double sample_time, Index samples) {
  const double apart = 2.0 / (sample_time * static_cast<double>(samples));
  std::sort(frequency.begin(), frequency.end());
  double below = 0.0;
  for (const double f : frequency) {
    if (!(f - below >= apart) || !(0.5 / sample_time - f >= apart)) {
      throw InputError("tone magnitude", std::to_string(f) + " Hz",
                       "frequencies at least " + std::to_string(apart) +
                           " Hz from each other, 0 and half the sampling rate");
    }
    below = f;
  }
}

/// Maximum of the Rice likelihood of all |a_j| by expectation maximisation.
double RiceMagnitude(const VectorXd& measured, const VectorXd& gain,
                     const VectorXd& variance) {
  const double information = (gain.array().square() / variance.array()).sum();
  double gamma =
      (gain.array() * measured.array() / variance.array()).sum() / information;
  for (int i = 0; i < 1000; ++i) {
    double sum = 0.0;
    for (Index j = 0; j < gain.size(); ++j) {
      const double x = measured[j] * gain[j] * gamma / variance[j];
      sum += gain[j] * measured[j] / variance[j] * Eigen::numext::bessel_i1e(x) /
             Eigen::numext::bessel_i0e(x);
    }
    const double before = gamma;
    gamma = sum / information;
    if (std::abs(gamma - before) <= 1e-12 * before) break;
  }
  return gamma;
}

}  // namespace

MagnitudeEstimate ToneMagnitude(const VectorXd& residual, double sample_time,
                                const VectorXd& frequency, const VectorXcd& gain,
                                const Spectrum& noise, TonePhase phase,
                                double start_time) {
  RequireRecord(residual, sample_time, kMinSegment);
  RequireResolved(frequency, sample_time, residual.size());
  if (frequency.size() == 0 || gain.size() != frequency.size() ||
      !(gain.squaredNorm() > 0.0)) {
    throw InputError("tone magnitude",
                     std::to_string(gain.size()) + " gains for " +
                         std::to_string(frequency.size()) + " frequencies",
                     "one for each, not all zero");
  }
  const VectorXd variance =
      FitVariance(residual.size(), sample_time) *
      frequency.unaryExpr([&](double f) { return DensityAt(noise, f); });
  if (!(variance.minCoeff() > 0.0)) {
    throw InputError("tone magnitude", "a noise density of zero", "more");
  }
  const VectorXd fit = FitSines(residual, sample_time, start_time, frequency);
  const VectorXcd amplitude = VectorXcd::NullaryExpr(frequency.size(), [&](Index j) {
    return std::complex<double>(fit[2 * j], fit[2 * j + 1]);
  });
  const double information = (gain.array().abs2() / variance.array()).sum();
  MagnitudeEstimate estimate;
  estimate.sd = 1.0 / std::sqrt(information);
  estimate.value =
      phase == TonePhase::kUnknown
          ? RiceMagnitude(amplitude.cwiseAbs(), gain.cwiseAbs(), variance)
          : ((gain.conjugate().array() * amplitude.array()).real() / variance.array())
                    .sum() /
                information;
  return estimate;
}

}  // namespace mjdiag
