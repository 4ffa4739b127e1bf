#include "mjdiag/diagnosis/disturbance/tone_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kSideBins = 12;    // bins beyond those that it must exceed
constexpr double kMainLobe = 2.5;  // bins; closer tones are one

/// Centre and strength from the five bins of the main lobe, which hold the power of
/// 1.5 bins at the centre's density wherever between bins it lies.
SpectralLine MakeLine(const Spectrum& spectrum, Index bin, double threshold) {
  const Index count = std::min<Index>(5, spectrum.density.size() - bin + 2);
  const auto lobe = spectrum.density.segment(bin - 2, count);
  const auto middle = static_cast<double>(bin);
  const VectorXd position = VectorXd::LinSpaced(
      count, middle - 2.0, middle + static_cast<double>(count) - 3.0);
  return {bin, lobe.dot(position) / lobe.sum(), std::sqrt(lobe.sum() / 1.5),
          spectrum.density[bin], threshold};
}

/// Upper bound on the Hann window's transform, x bins from its centre, relative to
/// that; a quarter of a bin is left for the centre's error.
double HannEnvelope(double x) {
  const double near = std::abs(x) - 0.25;
  if (near < 1.5) return 1.0;
  return 1.0 / (std::numbers::pi * near * (near * near - 1.0));
}

/// Upper bound on what the lines leak into a bin, square root of density. Each has its
/// images at negative frequency and beyond half the sampling rate.
double Leak(const std::vector<SpectralLine>& lines, Index bin, Index segment) {
  const auto k = static_cast<double>(bin);
  double leak = 0.0;
  for (const SpectralLine& line : lines) {
    leak += line.root * (HannEnvelope(k - line.centre) + HannEnvelope(k + line.centre) +
                         HannEnvelope(static_cast<double>(segment) - k - line.centre));
  }
  return leak;
}

/// Local maxima in the band, strongest first.
std::vector<Index> Candidates(const Spectrum& spectrum, const BinRange& bins) {
  std::vector<Index> candidates;
  for (const SpectralPeak& peak : FindPeaks(spectrum, 0.0)) {
    const Index bin = std::lround(peak.frequency / spectrum.resolution());
    if (bin >= bins.first && bin < bins.first + bins.count) candidates.push_back(bin);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [&](Index a, Index b) {
    return spectrum.density[a] > spectrum.density[b];
  });
  return candidates;
}

/// The higher of the medians of a density on either side, beyond the bins a tone
/// covers.
double SideMedian(const VectorXd& density, Index bin, const BinRange& bins) {
  const Index left = std::max(bins.first, bin - kSideBins - kToneBins);
  const Index right =
      std::min(bins.first + bins.count, bin + kSideBins + kToneBins + 1);
  double higher = 0.0;
  for (const auto& [first, end] :
       {std::pair{left, bin - kToneBins}, std::pair{bin + kToneBins + 1, right}}) {
    if (end <= first) continue;
    higher = std::max(higher, Median(density.segment(first, end - first)));
  }
  return higher;
}

/// The threshold of a bin but for what the lines found so far leak.
double OwnThreshold(const VectorXd& density, const DisturbanceThresholds& thresholds,
                    const DisturbanceOptions& options, const BinRange& bins, Index bin,
                    double floor, double quantile) {
  const double highest = thresholds.highest.segment(bin - 1, 3).maxCoeff();
  return std::max({quantile * floor, quantile * SideMedian(density, bin, bins),
                   (1.0 + options.peak_margin) * highest});
}

}  // namespace

void AddLines(const Spectrum& spectrum, const Spectrum& rest,
              const DisturbanceThresholds& thresholds,
              const DisturbanceOptions& options, const BinRange& bins, double dof,
              std::vector<SpectralLine>& lines) {
  const Spectrum floor = ExpectedNoise(rest, thresholds, bins, dof);
  const double quantile =
      FQuantile(options.tone_false_alarm / static_cast<double>(bins.count), dof,
                FloorDof(dof, thresholds.nominal_dof, bins.count));
  for (const Index bin : Candidates(spectrum, bins)) {
    const auto covers = [bin](const SpectralLine& line) {
      return std::abs(static_cast<double>(bin) - line.centre) < kMainLobe;
    };
    if (std::any_of(lines.begin(), lines.end(), covers)) continue;
    const double own = OwnThreshold(rest.density, thresholds, options, bins, bin,
                                    floor.density[bin], quantile);
    const double root = std::sqrt(own) + Leak(lines, bin, thresholds.segment);
    if (spectrum.density[bin] > root * root) {
      lines.push_back(MakeLine(spectrum, bin, root * root));
    }
  }
}

}  // namespace mjdiag
