#include "mjdiag/discovery/comparison/mismatch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

// A window needs enough samples for its rms to mean something.
constexpr Eigen::Index kShortestWindow = 16;

void CheckComparable(const Record& measured, const Record& simulated,
                     Eigen::Index skip) {
  if (measured.samples() != simulated.samples()) {
    throw InputError("comparison",
                     "the records have " + std::to_string(measured.samples()) +
                         " and " + std::to_string(simulated.samples()) + " samples",
                     "equal lengths");
  }
  const double step = measured.sample_time();
  if (std::abs(simulated.sample_time() - step) > 1e-4 * step) {
    throw InputError("comparison",
                     "the records are sampled every " + std::to_string(step) +
                         " s and " + std::to_string(simulated.sample_time()) + " s",
                     "equal sample times");
  }
  if (skip < 0 || measured.samples() - skip < 2) {
    throw InputError("comparison",
                     "a record of " + std::to_string(measured.samples()) +
                         " samples of which " + std::to_string(skip) + " are left out",
                     "at least two samples to compare");
  }
}

Eigen::Index WindowLength(const MismatchOptions& options, double sample_time,
                          Eigen::Index samples) {
  const double wanted = options.window > 0.0 ? options.window / sample_time
                                             : static_cast<double>(samples) / 50.0;
  const auto length = static_cast<Eigen::Index>(
      std::lround(std::min(wanted, static_cast<double>(samples))));
  return std::clamp(length, std::min(kShortestWindow, samples), samples);
}

/// Empty: all after the first `skip`.
SampleMask CountedAfter(const Channel& measured, Eigen::Index skip) {
  SampleMask counts = measured.measured;
  if (counts.size() > 0) counts.head(skip) = false;
  return counts;
}

double AnotherDrawTail(double rms, const std::vector<double>& draws) {
  if (draws.size() < 3) return 0.0;
  const Eigen::ArrayXd logs =
      Eigen::ArrayXd::Map(draws.data(), static_cast<Eigen::Index>(draws.size())).log();
  const auto n = static_cast<double>(logs.size());
  const double spread = std::sqrt((logs - logs.mean()).square().sum() / (n - 1.0));
  const double t = (std::log(rms) - logs.mean()) / (spread * std::sqrt(1.0 + 1.0 / n));
  return StudentExceedance(t, n - 1.0);
}

}  // namespace

double Rms(const Eigen::VectorXd& x) {
  return x.norm() / std::sqrt(static_cast<double>(x.size()));
}

Spectrum PowerSpectrum(const Eigen::VectorXd& x, double sample_time) {
  constexpr Eigen::Index kShortest = 64;
  constexpr Eigen::Index kLongest = 4096;
  Eigen::Index segment = kLongest;
  while (segment > kShortest && 8 * segment > x.size()) segment /= 2;
  return WelchDensity(x, sample_time, std::min(segment, x.size()));
}

double RelativeErrorPercent(const Eigen::VectorXd& measured,
                            const Eigen::VectorXd& simulated, Eigen::Index skip) {
  const Eigen::Index count = measured.size() - skip;
  const double error = (measured - simulated).tail(count).norm();
  if (error == 0.0) return 0.0;
  const double size = measured.tail(count).norm();
  if (size == 0.0) return std::numeric_limits<double>::infinity();
  return 100.0 * error / size;
}

double FitPercent(const Eigen::VectorXd& measured, const Eigen::VectorXd& simulated,
                  Eigen::Index skip) {
  const Eigen::Index count = measured.size() - skip;
  const double error = (measured - simulated).tail(count).norm();
  if (error == 0.0) return 100.0;
  const auto y = measured.tail(count);
  const double spread = (y.array() - y.mean()).matrix().norm();
  return 100.0 * (1.0 - error / spread);
}

double RelativeErrorPercent(const Channel& measured, const Channel& simulated,
                            Eigen::Index skip) {
  const SampleMask counts = CountedAfter(measured, skip);
  if (counts.size() == 0) {
    return RelativeErrorPercent(measured.samples, simulated.samples, skip);
  }
  return RelativeErrorPercent(Kept(measured.samples, counts),
                              Kept(simulated.samples, counts), 0);
}

double FitPercent(const Channel& measured, const Channel& simulated,
                  Eigen::Index skip) {
  const SampleMask counts = CountedAfter(measured, skip);
  if (counts.size() == 0) return FitPercent(measured.samples, simulated.samples, skip);
  return FitPercent(Kept(measured.samples, counts), Kept(simulated.samples, counts), 0);
}

Eigen::VectorXd MismatchOf(const Channel& measured, const Channel& simulated,
                           Eigen::Index skip) {
  const SampleMask counts = CountedAfter(measured, skip);
  if (counts.size() > 0) return Kept(measured.samples - simulated.samples, counts);
  return (measured.samples - simulated.samples).tail(measured.samples.size() - skip);
}

WorstWindow FindWorstWindow(const Eigen::VectorXd& mismatch, double sample_time,
                            double start_time, Eigen::Index length) {
  double energy = mismatch.head(length).squaredNorm();
  double largest = energy;
  Eigen::Index first = 0;
  for (Eigen::Index k = 1; k + length <= mismatch.size(); ++k) {
    const double leaving = mismatch[k - 1];
    const double entering = mismatch[k + length - 1];
    energy += entering * entering - leaving * leaving;
    if (energy > largest) {
      largest = energy;
      first = k;
    }
  }
  WorstWindow worst;
  worst.start = start_time + static_cast<double>(first) * sample_time;
  worst.duration = static_cast<double>(length) * sample_time;
  worst.rms = Rms(mismatch.segment(first, length));
  return worst;
}

double NoiseProbability(double rms, const NoiseFloor& floor) {
  if (floor.rms == 0.0) return rms > 0.0 ? 0.0 : 1.0;
  const double ratio = rms / floor.rms;
  return std::max(
      FExceedance(ratio * ratio, floor.mismatch_freedom, floor.floor_freedom),
      AnotherDrawTail(rms, floor.draws));
}

ChannelMismatch MeasureMismatch(const Record& measured, const Record& simulated,
                                const std::string& name, const NoiseFloor& floor,
                                const MismatchOptions& options) {
  const Eigen::Index skip = options.skip_samples;
  CheckComparable(measured, simulated, skip);
  const Channel& y = measured.At(name);
  const Channel& yhat = simulated.At(name);
  const double step = measured.sample_time();
  const Eigen::Index count = measured.samples() - skip;
  const Eigen::VectorXd error = MismatchOf(y, yhat, skip);
  const Eigen::Index counted = error.size();
  if (counted < 2) {
    throw InputError("comparison",
                     "'" + name + "' was measured at " + std::to_string(counted) +
                         " of the samples that count",
                     "at least two to compare");
  }
  // Along time, nothing is wrong where nothing was measured.
  Eigen::VectorXd in_time = (y.samples - yhat.samples).tail(count);
  if (counted < count) in_time = y.measured.tail(count).select(in_time, 0.0);

  ChannelMismatch result;
  result.name = name;
  result.unit = y.unit;
  result.rms = Rms(error);
  result.mae = error.cwiseAbs().mean();
  result.fit_percent = FitPercent(y, yhat, skip);
  result.peak = error.cwiseAbs().maxCoeff();
  result.relative_error_percent = RelativeErrorPercent(y, yhat, skip);
  result.worst = FindWorstWindow(
      in_time, step, measured.start_time() + static_cast<double>(skip) * step,
      WindowLength(options, step, count));
  if (counted < count) {
    const auto first =
        skip + std::lround((result.worst.start - measured.start_time()) / step -
                           static_cast<double>(skip));
    const auto length = std::lround(result.worst.duration / step);
    result.worst.rms *= std::sqrt(
        static_cast<double>(length) /
        std::max(1.0, static_cast<double>(y.measured.segment(first, length).count())));
  }
  // Between samples that were measured, on the average.
  const double share = static_cast<double>(counted) / static_cast<double>(count);
  result.spectrum = PowerSpectrum(error, step / share);
  result.noise_floor = floor;
  result.noise_floor.mismatch_freedom *= share;
  result.p_value = NoiseProbability(result.rms, result.noise_floor);
  result.exceeds_noise = result.p_value < options.level;
  return result;
}

}  // namespace mjdiag
