#include "mjdiag/discovery/comparison/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

// Enough to tell how much the power of the noise varies between runs.
constexpr int kDraws = 8;

/// Degrees of freedom of a variance that NoiseLevel estimates from n samples: its
/// relative standard deviation r = 1.2 sqrt(order / n) is that of a chi-square with
/// 1 / (2 r^2) of them.
double NoiseLevelFreedom(Eigen::Index n) {
  constexpr double kOrder = 6.0;
  return static_cast<double>(n) / (2.0 * 1.2 * 1.2 * kOrder);
}

/// The floor by several draws of the noise, whose standard deviation is an estimate
/// itself.
NoiseFloor FloorOf(const std::vector<Eigen::VectorXd>& draws, double sample_time) {
  NoiseFloor floor;
  double square = 0.0;
  for (const Eigen::VectorXd& noise : draws) {
    floor.draws.push_back(Rms(noise));
    square += floor.draws.back() * floor.draws.back();
    const Spectrum spectrum = PowerSpectrum(noise, sample_time);
    if (floor.spectrum.density.size() == 0) {
      floor.spectrum = spectrum;
    } else {
      floor.spectrum.density += spectrum.density;
    }
  }
  const auto count = static_cast<double>(draws.size());
  floor.rms = std::sqrt(square / count);
  floor.spectrum.density /= count;
  const Eigen::Index samples = draws.front().size();
  floor.mismatch_freedom = IndependentSamples(floor.spectrum, samples);
  floor.floor_freedom =
      1.0 / (1.0 / (count * floor.mismatch_freedom) + 1.0 / NoiseLevelFreedom(samples));
  return floor;
}

/// Runs that differ in the seed of their noise only, in parallel.
std::vector<Record> NoisyRuns(const Machine& machine, const Excitation& excitation,
                              const RunOptions& options) {
  std::vector<Record> records(kDraws);
  ParallelFor(
      kDraws,
      [&](int draw) {
        RunOptions noisy = options;
        noisy.noise_scale = 1.0;
        noisy.seed = options.seed + static_cast<std::uint64_t>(draw);
        noisy.progress = nullptr;
        records[static_cast<std::size_t>(draw)] = Simulate(machine, excitation, noisy);
      },
      options.progress);
  return records;
}

}  // namespace

double IndependentSamples(const Spectrum& spectrum, Eigen::Index n) {
  const Eigen::VectorXd& density = spectrum.density;
  const double squares = density.squaredNorm();
  if (squares == 0.0) return static_cast<double>(n);
  const double sum = density.sum();
  const auto bins = static_cast<double>(density.size());
  return std::max(1.0, static_cast<double>(n) * sum * sum / (bins * squares));
}

Eigen::VectorXd MeasuredNoise(const Channels& channels, const Record& measured) {
  Eigen::VectorXd sd(static_cast<Eigen::Index>(channels.sensors.size()));
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    const SensorSetup& sensor = channels.sensors[static_cast<std::size_t>(i)];
    const Channel* channel = measured.Find(sensor.channel);
    sd[i] = channel == nullptr ? sensor.noise_sd
                               : std::max(NoiseLevel(channel->Measured()),
                                          sensor.resolution / std::sqrt(12.0));
  }
  return sd;
}

std::map<std::string, NoiseFloor> EstimateNoiseFloor(const Machine& machine,
                                                     const Excitation& excitation,
                                                     const Record& clean,
                                                     const RunOptions& options,
                                                     Eigen::Index skip) {
  const std::vector<Record> noisy = NoisyRuns(machine, excitation, options);
  std::map<std::string, NoiseFloor> floors;
  const auto add = [&](const std::string& channel) {
    const Eigen::VectorXd& quiet = clean.At(channel).samples;
    std::vector<Eigen::VectorXd> draws;
    for (const Record& run : noisy) {
      const Eigen::VectorXd difference = run.At(channel).samples - quiet;
      draws.emplace_back(difference.tail(difference.size() - skip));
    }
    floors[channel] = FloorOf(draws, clean.sample_time());
  };
  for (const SensorSetup& sensor : machine.channels().sensors) add(sensor.channel);
  for (const ActuatorSetup& actuator : machine.channels().actuators)
    add(actuator.channel);
  return floors;
}

}  // namespace mjdiag
