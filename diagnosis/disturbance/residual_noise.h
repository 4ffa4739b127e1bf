#pragma once
// The noise of a disturbance residual, whatever tones there are in it, relative to that
// of the nominal runs. With S(f) the mean density of those, the whitened ratio R / S is
// level wherever noise has the nominal shape, and
//   B(f) = S(f) * median over neighbouring bins of R / S   (bias of the median removed)
// is the noise density expected in the record. R / B follows an F distribution with
//   nu1 = 36 K^2 / (19 K - 1)   of the record: 2 K / (1 + 2 rho (K - 1) / K) for K
//         segments under a Hann window with half overlap, whose powers are correlated
//         by rho = 1/36 (Welch 1967); less if the noise varies from segment to segment,
//   nu2   of S (the sum of nu1 over the nominal runs) and of the median.

#include <Eigen/Core>

#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

/// Bins each side that a tone covers itself.
inline constexpr Eigen::Index kToneBins = 3;

/// Bins in the band whose density is that of the signal: the lowest two have lost the
/// mean, the highest lacks a phase.
struct BinRange {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Those of a spectrum. InputError if there are fewer than 16.
BinRange UsableBins(const Spectrum& spectrum, const DisturbanceOptions& options);

/// K of a record.
Eigen::Index WelchSegments(Eigen::Index samples, Eigen::Index segment);

/// nu1 of the mean of K overlapping periodograms.
double WelchDof(Eigen::Index segments);

/// How noisy each segment is without the tones, of whatever amplitude they are in it.
struct SegmentNoise {
  /// Median of R / S of all bins that hold noise of their own.
  Eigen::VectorXd level;
  /// Sum of S df * median of R / S, block by block of bins. [unit^2]
  Eigen::VectorXd power;
};

/// @param thresholds  of which the segment's length and the nominal spectrum are used
/// @param tones       frequencies [Hz] of the sines taken out of each segment
SegmentNoise NoiseOfSegments(const Eigen::VectorXd& residual, double sample_time,
                             const DisturbanceThresholds& thresholds,
                             const BinRange& bins, const Eigen::VectorXd& tones);

/// nu1 of a record. Noise that comes and goes puts its power into few segments.
/// @param level  SegmentNoise::level
double RecordDof(const Eigen::VectorXd& level);

/// B.
/// @param spectrum  R, of a record without strong tones
/// @param dof       nu1 of that record
Spectrum ExpectedNoise(const Spectrum& spectrum,
                       const DisturbanceThresholds& thresholds, const BinRange& bins,
                       double dof);

/// nu2: that of S, less for the scatter of the median.
double FloorDof(double record_dof, double nominal_dof, Eigen::Index bins);

}  // namespace mjdiag
