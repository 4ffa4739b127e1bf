#include "mjdiag/signals/spectrum.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <unsupported/Eigen/FFT>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void RequireWelch(Index samples, double sample_time, Index segment, Index overlap) {
  if (!(sample_time > 0.0)) {
    throw InputError("spectrum", "sample time " + std::to_string(sample_time) + " s",
                     "a positive time");
  }
  if (segment < 2 || segment > samples) {
    throw InputError("spectrum", "segments of " + std::to_string(segment) + " samples",
                     "2 to the signal's " + std::to_string(samples));
  }
  if (overlap < 0 || overlap >= segment) {
    throw InputError("spectrum", "an overlap of " + std::to_string(overlap),
                     "0 to " + std::to_string(segment - 1));
  }
}

VectorXd HannWindow(Index length) {
  return VectorXd::NullaryExpr(length, [length](Index n) {
    const double sine = std::sin(std::numbers::pi * static_cast<double>(n) /
                                 static_cast<double>(length));
    return sine * sine;
  });
}

}  // namespace

Spectrum WelchDensity(const VectorXd& signal, double sample_time, Index segment,
                      Index overlap) {
  RequireWelch(signal.size(), sample_time, segment, overlap);
  const VectorXd window = HannWindow(segment);
  const Index bins = segment / 2 + 1;
  const Index step = segment - overlap;
  Eigen::FFT<double> fft;
  Eigen::VectorXcd transform;
  VectorXd power = VectorXd::Zero(bins);
  Index segments = 0;
  for (Index first = 0; first + segment <= signal.size(); first += step) {
    const auto part = signal.segment(first, segment);
    const VectorXd weighted = (part.array() - part.mean()) * window.array();
    fft.fwd(transform, weighted);
    power += transform.head(bins).cwiseAbs2();
    ++segments;
  }
  power *= 2.0 * sample_time / (window.squaredNorm() * static_cast<double>(segments));
  power[0] *= 0.5;
  if (segment % 2 == 0) power[bins - 1] *= 0.5;
  const double resolution = 1.0 / (static_cast<double>(segment) * sample_time);
  return {VectorXd::LinSpaced(bins, 0.0, static_cast<double>(bins - 1)) * resolution,
          power};
}

Spectrum WelchDensity(const VectorXd& signal, double sample_time, Index segment) {
  return WelchDensity(signal, sample_time, segment, segment / 2);
}

double BandPower(const Spectrum& spectrum, double low, double high) {
  const auto inside =
      spectrum.frequency.array() >= low && spectrum.frequency.array() <= high;
  return inside.select(spectrum.density.array(), 0.0).sum() * spectrum.resolution();
}

std::vector<SpectralPeak> FindPeaks(const Spectrum& spectrum, double threshold) {
  const VectorXd& density = spectrum.density;
  std::vector<SpectralPeak> peaks;
  for (Index k = 0; k < density.size(); ++k) {
    if (!(density[k] > threshold) || (k > 0 && density[k - 1] >= density[k])) continue;
    Index after = k;
    while (after < density.size() && density[after] == density[k]) ++after;
    if (after < density.size() && density[after] > density[k]) continue;
    peaks.push_back({spectrum.frequency[k], density[k]});
  }
  return peaks;
}

}  // namespace mjdiag
