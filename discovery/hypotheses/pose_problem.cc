// How a problem is posed: the noise of the sensors, and the observer.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Periods of the slowest error of the model that a record has to hold for it to count.
constexpr double kPeriods = 25.0;

/// That of a slow sensor pulls less often: as much more at a time it holds the same.
Observer AtPeriods(Observer observer, const MeasuredRun& run) {
  for (Index i = 0; i < observer.L.cols(); ++i) {
    const auto period = static_cast<double>(run.PeriodOf(i));
    if (period == 1.0) continue;
    observer.L.col(i) *= period;
    const double r = observer.noise_sd[i];
    const double fed_back =
        observer.innovation_sd[i] * observer.innovation_sd[i] - r * r;
    observer.innovation_sd[i] = std::sqrt(r * r + period * std::max(0.0, fed_back));
  }
  return observer;
}

double Floor(const SensorSetup& sensor, const Eigen::MatrixXd& outputs, Index row) {
  // A signal without any noise leaves rounding.
  const double rounding = 1e-12 * outputs.row(row).cwiseAbs().maxCoeff();
  return std::max({sensor.resolution / std::sqrt(12.0), rounding, 1e-15});
}

/// Samples after which an observer has forgotten where it began: the machine may have moved
/// then, or stood where a wrong encoder did not read it, to exp(-5) of it. Not more than
/// a tenth of the shortest record.
Index SettlingSamples(double hertz, const MeasuredRun& run) {
  constexpr double kForgotten = 5.0;
  constexpr Index kShare = 10;
  Index shortest = run.samples();
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    shortest = std::min(shortest, run.SamplesOf(i));
  }
  const double seconds = kForgotten / (2.0 * std::numbers::pi * hertz);
  const auto samples = static_cast<Index>(std::ceil(seconds / run.sample_time));
  return std::min(samples, shortest / kShare);
}

}  // namespace

Index LongestPeriod(const MeasuredRun& run) {
  Index longest = 1;
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    longest = std::max(longest, run.PeriodOf(i));
  }
  return longest;
}

VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run,
                     const Eigen::MatrixXd& innovations) {
  VectorXd sd(run.outputs.rows());
  for (Index i = 0; i < sd.size(); ++i) {
    const double of_record = NoiseLevel(run.ReadingsOf(i));
    const double of_innovations =
        innovations.size() > 0
            ? NoiseLevel(Kept(innovations.row(i), run.CountedOf(i, 0, run.samples())))
            : of_record;
    sd[i] =
        std::max(std::min(of_record, of_innovations),
                 Floor(channels.sensors[static_cast<std::size_t>(i)], run.outputs, i));
  }
  return sd;
}

double SlowestBandwidth(const MeasuredRun& run) {
  return kPeriods / run.Time().maxCoeff();
}

DiscoveryProblem PoseProblem(const Machine& machine, MeasuredRun run,
                             double train_share, double bandwidth) {
  // A tenth of the rate of the slowest sensor at most.
  const Index period = LongestPeriod(run);
  const double fastest = 0.1 * machine.rates().control / static_cast<double>(period);
  double hertz = bandwidth > 0.0 ? bandwidth : std::min(SlowestBandwidth(run), fastest);
  if (period > 1) hertz = std::min(hertz, fastest);
  const auto design = [&](const Eigen::MatrixXd& innovations) {
    return AtPeriods(
        DesignObserver(machine.linear(), machine.plant().opt.timestep,
                       machine.rates().substeps,
                       SensorNoise(machine.channels(), run, innovations), hertz),
        run);
  };
  // Twice: the noise is known better once the motion is taken out.
  const Observer first = design({});
  const Observer observer =
      design(FollowRun(machine, {}, run, first, false).innovations);
  const double share = run.records.size() > 1 ? 1.0 : train_share;
  const auto train =
      static_cast<Index>(std::lround(share * static_cast<double>(run.samples())));
  const Index skip = std::max<Index>(machine.setup().compare.skip_samples,
                                     SettlingSamples(hertz, run));
  return {machine, observer, std::move(run), skip, train};
}

DiscoveryProblem PoseProblem(const Machine& machine, const Record& measured,
                             double train_share, double bandwidth) {
  return PoseProblem(machine, ToMeasuredRun(machine.setup(), measured), train_share,
                     bandwidth);
}

}  // namespace mjdiag
