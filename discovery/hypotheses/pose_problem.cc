// How a problem is posed: the noise of the sensors, and the observer.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/replay/motion_noise.h"
#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Periods of the slowest error of the model that a record has to hold for it to count.
constexpr double kPeriods = 25.0;

/// That of a slow sensor pulls less often.
Observer AtPeriods(Observer observer, const MeasuredRun& run) {
  VectorXd periods(observer.L.cols());
  for (Index i = 0; i < periods.size(); ++i) {
    periods[i] = static_cast<double>(run.PeriodOf(i));
  }
  if ((periods.array() != 1.0).any()) ScaleGain(periods, observer);
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

/// Whether a machine that leaves its rest is where the readings are: of its first order,
/// which is taken there, the second then leaves a hundredth.
bool IsBeside(const MeasuredRun& run, const Track& track) {
  constexpr double kShare = 0.01;  // of the span of the readings
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    const double span = run.outputs.row(i).maxCoeff() - run.outputs.row(i).minCoeff();
    if (track.innovations.row(i).cwiseAbs().maxCoeff() > kShare * span) return false;
  }
  return true;
}

/// The nominal machine beside an observer, nothing if it does not stay beside the run.
std::optional<Track> Beside(const Machine& machine, const MeasuredRun& run,
                            const Observer& observer) {
  if (!observer.following) return FollowRun(machine, {}, run, observer, false);
  try {
    Track track = FollowRun(machine, {}, run, observer, false);
    if (IsBeside(run, track)) return track;
  } catch (const NumericalError&) {
    // Further from the readings than that.
  }
  return std::nullopt;
}

/// The observer of a problem. Twice: the noise is known better once the motion is taken
/// out. Of a machine that leaves its rest the slowest that keeps it beside the readings:
/// what the model lacks must not bend it into another configuration.
Observer Pose(const Machine& machine, const MeasuredRun& run, double hertz,
              double fastest) {
  constexpr double kFaster = 1.5;
  std::shared_ptr<const MotionPath> path;
  VectorXd in_motion;
  for (const double first = hertz;; hertz *= kFaster) {
    // One that was asked for may be faster.
    if (hertz > std::max(first, fastest)) {
      throw NumericalError("replay: no observer of up to " +
                           FormatQuantity(fastest, "Hz") +
                           " keeps the plant within 1 % of the record: readings of a "
                           "higher rate would, or a plant that lacks less");
    }
    const auto design = [&](const Eigen::MatrixXd& innovations) {
      VectorXd noise = SensorNoise(machine.channels(), run, innovations);
      if (in_motion.size() > 0) noise = noise.cwiseMax(in_motion);
      Observer observer =
          AtPeriods(DesignObserver(machine, run, noise, hertz, path), run);
      return observer;
    };
    Observer start = design({});
    if (start.following && !path) {
      path = start.following->path;
      in_motion = NoiseInMotion(machine, run, start.noise_sd, path);
      start = design({});
    }
    const auto beside = Beside(machine, run, start);
    if (!beside) continue;
    Observer observer = design(beside->innovations);
    if (!observer.following || Beside(machine, run, observer)) return observer;
  }
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
  const Observer observer = Pose(machine, run, hertz, fastest);
  hertz = observer.bandwidth;
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
