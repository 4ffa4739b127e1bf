#include "mjdiag/diagnosis/disturbance/residual_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/disturbance/sine_fit.h"
#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kMinBins = 16;
constexpr Index kNeighbours = 32;  // bins each side that make the local floor

VectorXd Whitened(const VectorXd& density, const VectorXd& nominal,
                  const BinRange& bins) {
  const VectorXd expected = nominal.cwiseMax(1e-30 * nominal.maxCoeff());
  return (density.array() / expected.array()).segment(bins.first, bins.count);
}

/// The median of R / S, where S is not just what the window leaks from elsewhere: all
/// such bins rise and fall together.
double Level(const VectorXd& ratio, const Spectrum& nominal, const BinRange& bins) {
  const auto expected = nominal.density.segment(bins.first, bins.count);
  const double least = 1e-12 * expected.maxCoeff();
  std::vector<double> values;
  for (Index k = 0; k < bins.count; ++k) {
    if (expected[k] >= least) values.push_back(ratio[k]);
  }
  return Median(Eigen::Map<VectorXd>(values.data(), static_cast<Index>(values.size())));
}

/// Sum over blocks of the power of S times the median of R / S.
double BlockPower(const VectorXd& ratio, const Spectrum& nominal,
                  const BinRange& bins) {
  double power = 0.0;
  for (Index first = 0; first < bins.count; first += 2 * kNeighbours) {
    const Index size = std::min(2 * kNeighbours, bins.count - first);
    power += Median(ratio.segment(first, size)) *
             nominal.density.segment(bins.first + first, size).sum();
  }
  return power * nominal.resolution();
}

/// The median of the bins around each one, without those that a tone there covers.
VectorXd LocalMedian(const VectorXd& ratio) {
  VectorXd floor(ratio.size());
  std::vector<double> around;
  for (Index k = 0; k < ratio.size(); ++k) {
    around.clear();
    const Index end = std::min(ratio.size(), k + kNeighbours + 1);
    for (Index j = std::max<Index>(0, k - kNeighbours); j < end; ++j) {
      if (std::abs(j - k) > kToneBins) around.push_back(ratio[j]);
    }
    floor[k] =
        Median(Eigen::Map<VectorXd>(around.data(), static_cast<Index>(around.size())));
  }
  return floor;
}

}  // namespace

BinRange UsableBins(const Spectrum& spectrum, const DisturbanceOptions& options) {
  BinRange bins;
  for (Index k = 2; k + 1 < spectrum.frequency.size(); ++k) {
    if (spectrum.frequency[k] < options.low || spectrum.frequency[k] > options.high) {
      continue;
    }
    if (bins.count++ == 0) bins.first = k;
  }
  if (bins.count < kMinBins) {
    throw InputError("disturbance spectrum",
                     "a band of " + std::to_string(bins.count) + " bins of " +
                         std::to_string(spectrum.resolution()) + " Hz",
                     "at least " + std::to_string(kMinBins));
  }
  return bins;
}

Index WelchSegments(Index samples, Index segment) {
  return (samples - segment) / (segment - segment / 2) + 1;
}

double WelchDof(Index segments) {
  const auto count = static_cast<double>(segments);
  return 36.0 * count * count / (19.0 * count - 1.0);
}

SegmentNoise NoiseOfSegments(const VectorXd& residual, double sample_time,
                             const DisturbanceThresholds& thresholds,
                             const BinRange& bins, const VectorXd& tones) {
  const Index length = thresholds.segment;
  const Index count = WelchSegments(residual.size(), length);
  // Of a periodogram, which has two degrees of freedom.
  const double bias = FQuantile(0.5, 2.0, thresholds.nominal_dof);
  SegmentNoise noise{VectorXd(count), VectorXd(count)};
  for (Index s = 0; s < count; ++s) {
    VectorXd part = residual.segment(s * (length - length / 2), length);
    if (tones.size() > 0) {
      part = WithoutSines(part, sample_time, tones,
                          FitSines(part, sample_time, 0.0, tones));
    }
    const VectorXd ratio = Whitened(WelchDensity(part, sample_time, length).density,
                                    thresholds.nominal.density, bins);
    noise.level[s] = Level(ratio, thresholds.nominal, bins) / bias;
    noise.power[s] = BlockPower(ratio, thresholds.nominal, bins) / bias;
  }
  return noise;
}

double RecordDof(const VectorXd& level) {
  const double most = WelchDof(level.size());
  const double power = level.squaredNorm();
  if (!(power > 0.0)) return most;
  const double evenness =
      level.sum() * level.sum() / (static_cast<double>(level.size()) * power);
  return std::max(2.0, evenness * most);
}

Spectrum ExpectedNoise(const Spectrum& spectrum,
                       const DisturbanceThresholds& thresholds, const BinRange& bins,
                       double dof) {
  const VectorXd local =
      LocalMedian(Whitened(spectrum.density, thresholds.nominal.density, bins)) /
      FQuantile(0.5, dof, thresholds.nominal_dof);
  Spectrum floor = thresholds.nominal;
  auto& density = floor.density;
  density.head(bins.first) *= local[0];
  density.segment(bins.first, bins.count).array() *= local.array();
  density.tail(density.size() - bins.first - bins.count) *= local[bins.count - 1];
  return floor;
}

// Under a Hann window neighbouring bins are correlated by 4/9 and 1/36 in power, so n
// of them count as n / 1.94.
double FloorDof(double record_dof, double nominal_dof, Index bins) {
  const double count =
      static_cast<double>(std::min(bins - 1, kNeighbours) - kToneBins) / 1.94;
  const double median_variance =
      0.5 * std::numbers::pi * (2.0 / record_dof + 2.0 / nominal_dof) / count;
  return 2.0 / (2.0 / nominal_dof + median_variance);
}

}  // namespace mjdiag
