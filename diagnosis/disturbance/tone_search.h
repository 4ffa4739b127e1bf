#pragma once
// The search for tones in a residual's spectrum R: local maxima that exceed the
// threshold of disturbance_spectrum.h there, the strongest first, since each one found
// raises the threshold of its neighbours by what a Hann window leaks from it.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/diagnosis/disturbance/residual_noise.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

struct SpectralLine {
  Eigen::Index bin = 0;
  double centre = 0.0;  ///< [bins]
  double root = 0.0;    ///< square root of the density at the centre
  double psd = 0.0;     ///< R at the bin
  double threshold = 0.0;
};

/// Adds the lines that stand out of the rest, which is the record without those already
/// in the list.
/// @param spectrum  R
/// @param rest      R without the lines in the list
/// @param dof       nu1 of the record
void AddLines(const Spectrum& spectrum, const Spectrum& rest,
              const DisturbanceThresholds& thresholds,
              const DisturbanceOptions& options, const BinRange& bins, double dof,
              std::vector<SpectralLine>& lines);

}  // namespace mjdiag
