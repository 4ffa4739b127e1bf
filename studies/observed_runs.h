#pragma once
// What an observer of a machine (observer.h) sees of runs with something in it that it does
// not know: its innovations over what noise alone makes of them, one sample after the other.
// By that the sizes of hidden effects are drawn, and by nothing that is to find them.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/error_dynamics.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class ObservedRuns {
 public:
  /// @param machine  whose observer it is, with the noise of its sensors
  /// @param motion   of all runs
  ObservedRuns(const Machine& machine, const Excitation& motion);

  const Machine& machine() const { return machine_; }
  /// The motion of the machine as it is, without noise.
  const ObservedMotion& motion() const { return motion_; }

  /// A run of that machine, without noise. NumericalError if it diverges.
  MeasuredRun RunOf(const Machine& measured) const;
  /// Beside the machine with those changes; 0 until the observer has forgotten where it began,
  /// to exp(-5) of it: the machine may have moved then. NumericalError if it diverges.
  Eigen::VectorXd Innovations(const MeasuredRun& run, const Changes& beside = {}) const;
  /// Of a run of the machine with those causes in it.
  Eigen::VectorXd InnovationsOf(const Changes& changes) const;

  /// What a trial of an effect shows to first order, a column for every amplitude.
  /// @param channel  of a trial in the readings
  Eigen::MatrixXd Response(const CandidateRegressor& trial, Eigen::Index channel) const;
  /// The same of forces at the degrees of freedom. @param forces  samples x nv
  Eigen::VectorXd ResponseTo(const Eigen::MatrixXd& forces) const;
  /// The trial of a sweep that has most in common with innovations.
  CandidateRegressor BestOf(const ParameterScan& sweep, Eigen::Index channel,
                            const Eigen::VectorXd& innovations) const;

 private:
  Machine machine_;
  Excitation excitation_;
  MeasuredRun quiet_;
  Observer observer_;
  Eigen::Index settling_ = 0;  ///< innovations at the start that count for nothing
  ErrorDynamics dynamics_;
  ObservedMotion motion_;
};

}  // namespace mjdiag
