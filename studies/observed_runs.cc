#include "mjdiag/studies/observed_runs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Periods of the slowest error of the model that a record has to hold for it to count.
constexpr double kPeriods = 25.0;

MeasuredRun QuietRun(const Machine& machine, const Excitation& motion) {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  return ToMeasuredRun(machine.setup(), Simulate(machine, motion, quiet));
}

VectorXd NoiseOf(const Channels& channels) {
  VectorXd sd(std::ssize(channels.sensors));
  for (Index i = 0; i < sd.size(); ++i) {
    const SensorSetup& sensor = channels.sensors[static_cast<std::size_t>(i)];
    sd[i] = std::max({sensor.noise_sd, sensor.resolution / std::sqrt(12.0), 1e-15});
  }
  return sd;
}

Observer ObserverOf(const Machine& machine, const MeasuredRun& run) {
  return DesignObserver(machine.linear(), machine.plant().opt.timestep,
                        machine.rates().substeps, NoiseOf(machine.channels()),
                        kPeriods / run.Time().maxCoeff());
}

Index SettlingOf(const MeasuredRun& run, const Observer& observer) {
  constexpr double kForgotten = 5.0;
  const double seconds = kForgotten / (2.0 * std::numbers::pi * observer.bandwidth);
  const auto samples = static_cast<Index>(std::ceil(seconds / run.sample_time));
  return run.outputs.rows() * std::min(samples, run.samples());
}

}  // namespace

ObservedRuns::ObservedRuns(const Machine& machine, const Excitation& motion)
    : machine_(machine),
      excitation_(motion),
      quiet_(QuietRun(machine, motion)),
      observer_(ObserverOf(machine, quiet_)),
      settling_(SettlingOf(quiet_, observer_)),
      dynamics_(observer_, 1) {
  motion_ = ObserveMotion(machine_, quiet_,
                          RunPredictor(machine_, {}, quiet_, observer_, dynamics_));
}

MeasuredRun ObservedRuns::RunOf(const Machine& measured) const {
  return QuietRun(measured, excitation_);
}

VectorXd ObservedRuns::Innovations(const MeasuredRun& run,
                                   const Changes& beside) const {
  const InnovationSequence track =
      RunPredictor(machine_, beside, run, observer_, false);
  VectorXd scaled =
      (observer_.innovation_sd.cwiseInverse().asDiagonal() * track.innovations)
          .reshaped();
  scaled.head(settling_).setZero();
  return scaled;
}

VectorXd ObservedRuns::InnovationsOf(const Changes& changes) const {
  return Innovations(RunOf(machine_.With(changes)));
}

MatrixXd ObservedRuns::Response(const CandidateRegressor& trial, Index channel) const {
  MatrixXd all = trial.entry.size() > 0 ? dynamics_.OfForces(trial.entry, trial.signals)
                                        : dynamics_.OfReadings(channel, trial.signals);
  all.topRows(settling_).setZero();
  return trial.summed ? MatrixXd(all.rowwise().sum()) : all;
}

VectorXd ObservedRuns::ResponseTo(const MatrixXd& forces) const {
  const MatrixXd at_every = MatrixXd::Identity(forces.cols(), forces.cols());
  VectorXd all = dynamics_.OfForces(at_every, forces).rowwise().sum();
  all.head(settling_).setZero();
  return all;
}

CandidateRegressor ObservedRuns::BestOf(const ParameterScan& sweep, Index channel,
                                        const VectorXd& innovations) const {
  const ErrorDynamics::Adjoint adjoint = dynamics_.AdjointOf(innovations);
  CandidateRegressor best;
  double most = -1.0;
  for (const double value : sweep.values) {
    CandidateRegressor trial = sweep.make(value);
    VectorXd common(trial.signals.cols());
    for (Index i = 0; i < common.size(); ++i) {
      const auto signal = trial.signals.col(i).head(adjoint.forces.rows());
      const VectorXd asked = trial.entry.size() > 0
                                 ? VectorXd(adjoint.forces * trial.entry.col(i))
                                 : VectorXd(adjoint.readings.col(channel));
      common[i] = signal.dot(asked);
    }
    const double size = trial.signals.squaredNorm();
    const double share = size > 0.0 ? common.squaredNorm() / size : 0.0;
    if (!(share > most)) continue;
    most = share;
    best = std::move(trial);
  }
  return best;
}

}  // namespace mjdiag
