#include "mjdiag/discovery/answer/raised_noise.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/record.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Rms that white noise has which is as strong as `signal` is in the upper half of the
/// band: there the observer follows nothing, and innovations are the noise itself.
double UpperRms(const VectorXd& signal, double sample_time) {
  constexpr Index kSegment = 256;
  if (signal.size() < kSegment) return 0.0;
  const Spectrum spectrum = WelchDensity(signal, sample_time, kSegment);
  const double highest = 0.5 / sample_time;
  return std::sqrt(2.0 * BandPower(spectrum, 0.5 * highest, highest));
}

/// Whether the mean squares of short parts of a signal differ by more than those of white
/// noise do, which is 2 / n of their square in variance, and by more than a fraction of
/// what the whole has more than `expected`.
bool IsUnsteady(const VectorXd& signal, double expected) {
  constexpr Index kPart = 64;
  constexpr double kSigmas = 5.0;
  constexpr double kFraction = 0.25;
  const Index parts = signal.size() / kPart;
  if (parts < 2) return false;
  const VectorXd square =
      signal.head(kPart * parts).reshaped(kPart, parts).colwise().squaredNorm() / kPart;
  const double mean = square.mean();
  const double variance =
      (square.array() - mean).square().sum() / static_cast<double>(parts - 1);
  const double by_chance = 2.0 * mean * mean / static_cast<double>(kPart);
  // Of a variance of normal values; these are nearly that.
  const double error = by_chance * std::sqrt(2.0 / static_cast<double>(parts - 1));
  const double more = kFraction * (mean - expected * expected);
  return variance - by_chance > std::max(kSigmas * error, more * more);
}

}  // namespace

std::vector<RaisedNoise> FindRaisedNoise(const Setup& setup, const Observer& observer,
                                         const Eigen::MatrixXd& innovations,
                                         double share,
                                         const Eigen::ArrayXX<bool>& measured) {
  constexpr double kSigmas = 5.0;
  constexpr double kLeast = 0.02;
  const auto all = static_cast<Index>(share * static_cast<double>(innovations.cols()));
  std::vector<RaisedNoise> found;
  for (std::size_t i = 0; i < setup.channels.sensors.size(); ++i) {
    const SensorSetup& sensor = setup.channels.sensors[i];
    const auto row = static_cast<Index>(i);
    VectorXd seen = innovations.row(row).head(all);
    if (measured.size() > 0) seen = Kept(seen, measured.row(row).head(all).transpose());
    const Index n = seen.size();
    const double expected =
        std::hypot(sensor.noise_sd, sensor.resolution / std::sqrt(12.0));
    if (sensor.noise_sd <= 0.0 || n < 2) continue;
    // What the observer makes of white noise of unit standard deviation.
    const double colouring = observer.innovation_sd[row] / observer.noise_sd[row];
    const double rms =
        std::sqrt(seen.squaredNorm() / static_cast<double>(n)) / colouring;
    const double error = rms / std::sqrt(2.0 * static_cast<double>(n));
    if (rms - expected < std::max(kSigmas * error, kLeast * expected)) continue;
    // The mean square of half of the band is less certain by sqrt(2), that of their
    // difference as that of the whole.
    const double upper = UpperRms(
        seen, setup.rates.tick() * static_cast<double>(all) / static_cast<double>(n));
    if (rms - upper > std::max(kSigmas * error, kLeast * rms)) continue;
    if (IsUnsteady(seen / colouring, expected)) continue;
    const double raised = std::sqrt(rms * rms - expected * expected);
    found.push_back({sensor.element, sensor.unit, raised, error * rms / raised});
  }
  return found;
}

}  // namespace mjdiag
