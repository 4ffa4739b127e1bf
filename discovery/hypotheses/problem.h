#pragma once
// A discovery in hand: the nominal machine, the measured run and the observer that
// compares them. What screening, fit and search share.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <utility>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct DiscoveryProblem {
  Machine machine;  ///< the nominal one
  Observer observer{};
  MeasuredRun run;
  Eigen::Index skip = 0;   ///< samples at the start that count for nothing
  Eigen::Index train = 0;  ///< samples that a fit sees; the rest is held out

  double step() const { return machine.plant().opt.timestep; }  ///< of physics [s]
  /// Innovations over their standard deviation with those changes, stacked sample by
  /// sample, (ny samples).
  Eigen::VectorXd Residual(const Changes& changes) const;
  Eigen::VectorXd Scaled(const Track& track) const;
  /// The run with those changes and its first order, in blocks: some thousand of them
  /// hold what forces do to a machine with inertia.
  std::pair<Track, ErrorDynamics> Linearised(const Changes& changes) const;
  /// Speed of every joint below which dry friction holds it: a fiftieth of the sensor
  /// noise a tick, nv.
  Eigen::VectorXd StillSpeed() const;
};

/// Noise of the sensors from the record and from the innovations of the nominal plant,
/// whichever is lower: what moves in a record is not noise. [unit of each sensor]
Eigen::VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run,
                            const Eigen::MatrixXd& innovations);

/// @param train_share  of the record that fits see, 0 to 1
/// @param bandwidth    of the observer [Hz]; 0: 25 over the duration of the record
DiscoveryProblem PoseProblem(const Machine& machine, const Record& measured,
                             double train_share, double bandwidth);

/// The problem cut to the first `samples` samples, all of them for the fit.
DiscoveryProblem Beginning(const DiscoveryProblem& problem, Eigen::Index samples);

/// Mean square of the rows of samples first .. last - 1.
double MeanSquare(const Eigen::VectorXd& residual, Eigen::Index channels,
                  Eigen::Index first, Eigen::Index last);

}  // namespace mjdiag
