#include "mjdiag/discovery/hypotheses/problem.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Periods of the slowest error of the model that a record has to hold for it to count.
constexpr double kPeriods = 25.0;

double Floor(const SensorSetup& sensor, const Eigen::MatrixXd& outputs, Index row) {
  // A signal without any noise leaves rounding.
  const double rounding = 1e-12 * outputs.row(row).cwiseAbs().maxCoeff();
  return std::max({sensor.resolution / std::sqrt(12.0), rounding, 1e-15});
}

}  // namespace

VectorXd DiscoveryProblem::Scaled(const Track& track) const {
  const Eigen::MatrixXd scaled =
      observer.innovation_sd.cwiseInverse().asDiagonal() * track.innovations;
  return Eigen::Map<const VectorXd>(scaled.data(), scaled.size());
}

VectorXd DiscoveryProblem::StillSpeed() const {
  constexpr double kShare = 0.02;
  const double noise = observer.noise_sd.minCoeff();
  return VectorXd::Constant(machine.plant().nv, kShare * noise / run.sample_time);
}

VectorXd DiscoveryProblem::Residual(const Changes& changes) const {
  return Scaled(FollowRun(machine, changes, run, observer, false));
}

std::pair<Track, ErrorDynamics> DiscoveryProblem::Linearised(
    const Changes& changes) const {
  constexpr Eigen::Index kBlocks = 5000;
  ErrorDynamics dynamics(observer, std::max<Eigen::Index>(1, run.samples() / kBlocks));
  Track track = FollowRun(machine, changes, run, observer, dynamics);
  return {std::move(track), std::move(dynamics)};
}

VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run,
                     const Eigen::MatrixXd& innovations) {
  VectorXd sd(run.outputs.rows());
  for (Index i = 0; i < sd.size(); ++i) {
    const double of_record = NoiseLevel(run.outputs.row(i));
    const double of_innovations =
        innovations.size() > 0 ? NoiseLevel(innovations.row(i)) : of_record;
    sd[i] =
        std::max(std::min(of_record, of_innovations),
                 Floor(channels.sensors[static_cast<std::size_t>(i)], run.outputs, i));
  }
  return sd;
}

DiscoveryProblem PoseProblem(const Machine& machine, const Record& measured,
                             double train_share, double bandwidth) {
  DiscoveryProblem problem{.machine = machine,
                           .run = ToMeasuredRun(machine.setup(), measured)};
  problem.skip = machine.setup().compare.skip_samples;
  problem.train = static_cast<Index>(
      std::lround(train_share * static_cast<double>(measured.samples())));
  const double hertz = bandwidth > 0.0 ? bandwidth
                                       : std::min(kPeriods / measured.duration(),
                                                  0.1 * machine.rates().control);
  // Twice: the noise is known better once the motion is taken out.
  Eigen::MatrixXd innovations;
  for (int round = 0; round < 2; ++round) {
    problem.observer = DesignObserver(
        machine.linear(), problem.step(), machine.rates().substeps,
        SensorNoise(machine.channels(), problem.run, innovations), hertz);
    if (round == 0) {
      innovations =
          FollowRun(machine, {}, problem.run, problem.observer, false).innovations;
    }
  }
  return problem;
}

DiscoveryProblem Beginning(const DiscoveryProblem& problem, Index samples) {
  DiscoveryProblem cut = problem;
  cut.run.outputs = problem.run.outputs.leftCols(samples);
  cut.run.inputs = problem.run.inputs.leftCols(samples);
  cut.train = samples;
  return cut;
}

double MeanSquare(const VectorXd& residual, Index channels, Index first, Index last) {
  if (last <= first) return 0.0;
  return residual.segment(channels * first, channels * (last - first)).squaredNorm() /
         static_cast<double>(channels * (last - first));
}

}  // namespace mjdiag
