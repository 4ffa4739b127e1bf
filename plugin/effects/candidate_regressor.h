#pragma once
// How an effect would show, to first order: the force (or the error of a reading) that
// it makes along the observed motion, with its shape parameters (a period, a frequency,
// a length) on a grid and its amplitudes free. Every grid point is a trial, and linear
// least squares on the innovations judges it.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/effects/site.h"

namespace mjdiag {

using Amplitudes = Eigen::VectorXd;
/// Values of an effect's parameters, in their order, for amplitudes; none: not
/// physical.
using RegressorValues = std::optional<Eigen::VectorXd>;

struct CandidateRegressor {
  Eigen::MatrixXd signals;  ///< samples x amplitudes: force or error of the reading
  Eigen::MatrixXd entry;    ///< nq x amplitudes, of forces; empty: errors of a reading
  std::function<RegressorValues(const Amplitudes&)> values;
  /// What each amplitude is at least, at most 0; of no size: anything.
  Amplitudes least = {};
  bool summed = false;  ///< all signals have one amplitude: one fault, several joints
};

/// CandidateRegressors over one parameter that has to be met closely: a period or a frequency. Each
/// is the sine and the cosine of an angle, which grows evenly from one to the next.
struct ParameterScan {
  std::vector<double> values;  ///< slowest first, close enough to miss no maximum
  /// How many there are as far as the motion tells them apart, and which they are.
  Eigen::Index count = 0;
  std::function<double(Eigen::Index)> value;
  Eigen::VectorXd angle;      ///< of the first value, samples [rad]
  Eigen::VectorXd increment;  ///< from one value to the next, samples [rad]
  std::function<CandidateRegressor(double)> make;
};

/// The observed motion at a site. Does not own what it refers to.
struct SiteMotion {
  const mjModel& plant;
  const MechanicalModel& model;
  const ObservedMotion& motion;
  const Site& site;

  Eigen::VectorXd q() const { return motion.position.row(site.joint); }
  Eigen::VectorXd v() const { return motion.velocity.row(site.joint); }
  Eigen::VectorXd a() const { return motion.acceleration.row(site.joint); }
  Eigen::VectorXd own_a() const { return motion.own_acceleration.row(site.joint); }
  Eigen::VectorXd u() const { return motion.inputs.row(site.channel); }
  Eigen::VectorXd y() const { return motion.outputs.row(site.channel); }
  /// The force of all motors on the joint, to first order in what they are driven by.
  Eigen::VectorXd motor() const;
  /// The force of the motor of the channel before its gear, as MotorForce has it, with
  /// its arm at qpos0.
  Eigen::VectorXd before_gear() const;
  /// Of `columns` forces on the joint, or commands of the actuator.
  Eigen::MatrixXd JointEntry(Eigen::Index columns = 1) const;
  Eigen::MatrixXd MotorEntry(Eigen::Index columns = 1) const;
};

/// One amplitude for each parameter, in their order, and no shape: value = offset +
/// amplitude, which may be asked to be at least 0.
CandidateRegressor LinearRegressor(Eigen::MatrixXd signals, Eigen::MatrixXd entry,
                                   double offset = 0.0, bool not_negative = false);

}  // namespace mjdiag
