#pragma once
// The balance of forces along a measured motion: at every sample the plant is put where
// the filtered readings say that the machine was, moving as fast, and driven by the
// inputs of one control tick. What it then lacks is a generalised force
//
//   F = M(q) q'' / g - H[M(q) a / g],     a: the plant's own acceleration over the tick
//
// along all joints: friction that nobody wrote down, a mass that is another one. It is
// inverse dynamics with MuJoCo's own steps, with every effect and every stuck joint in it.
// H is the Butterworth low-pass of fourth order, forwards and backwards in time, through
// which the readings went, so that noise of q'' stays small. All that the plant does by
// itself goes through it once, as the forces did that moved the machine: its dry friction,
// which jumps, and what drove it, which answers that. (M. Gautier, A. Janot, P.-O.
// Vandanjon, "A New Closed-Loop Output Error Method for Parameter Identification of Robot
// Dynamics", IEEE Trans. Control Systems Technology 21, 2013, on this way of preparing
// records of arms.)

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// A measured run as its joints moved, filtered. What does not depend on what is tried.
struct FilteredRun {
  MeasuredRun run;           ///< inputs and outputs filtered
  Eigen::MatrixXd inputs;    ///< as they were measured, actuators x samples
  Eigen::MatrixXd position;  ///< nq x samples
  Eigen::MatrixXd velocity;  ///< nv x samples
  /// Mean of the tick that begins there, as the plant's own is, nv x samples.
  Eigen::MatrixXd acceleration;
  /// Of every sample, whether it is measured and a period of the band away from the ends
  /// of its record, where filters and differences see only one side.
  SampleMask counts;
  double bandwidth = 0.0;  ///< [Hz]
};

/// Of the filter of a run [Hz]: the fastest force that goes with the motion,
/// or what a filter at the control rate still tells from noise.
double BalanceBandwidth(const Machine& machine, const MeasuredRun& run);

/// @param bandwidth  of the filter [Hz], below half the control rate
/// InputError if the readings do not say where the joints are.
FilteredRun FilterRun(const Machine& machine, const MeasuredRun& run, double bandwidth);

/// A signal of every sample through the same filter, record by record.
Eigen::VectorXd LowPassed(const FilteredRun& filtered, const Eigen::VectorXd& signal);

/// g of every degree of freedom, nv.
Eigen::VectorXd DriveFactors(const Machine& machine, const Machine& changed);

/// Of every joint and sample, nv x samples.
using JointMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

struct ForceBalance {
  ObservedMotion motion;    ///< own_acceleration is a
  Eigen::MatrixXd missing;  ///< F, nv x samples [N, N m]
  /// Where the plant's own dry friction (`frictionloss`) is below its bound: it takes most of
  /// what would be missing, nv x samples.
  JointMask sticks;
};

/// NumericalError if the plant diverges in a tick.
ForceBalance InverseDynamicsResidual(const Machine& machine, const Changes& changes,
                                     const FilteredRun& filtered);

/// F without the dry friction of the plant, which MuJoCo has as `frictionloss`.
Eigen::MatrixXd MissingWithoutFriction(const Machine& machine,
                                       const FilteredRun& filtered,
                                       const ForceBalance& balance);

/// Root mean square of every row of F over the samples that count, nv.
Eigen::VectorXd MissingRms(const FilteredRun& filtered, const Eigen::MatrixXd& missing);

}  // namespace mjdiag
