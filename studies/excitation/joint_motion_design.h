#pragma once
// Which motion next, of a machine whose controllers are not known: an arm that was measured
// while it went some motion. One as long as that, within the limits of its joints, along
// which the forces tell the inertial and friction numbers apart best (inertial_regressor.h):
// with W the rows Y of that motion over the noise of every joint, columns those that any
// motion within the limits tells (base parameters [Gautier 1991], by a QR decomposition with
// pivots),
//
//   condition number of W -> least,   sd of the numbers = sqrt diag (W^T W)^-1.
//
// The noise is what no such numbers explain of the record. Values closer than half a period
// of its band tell nothing new.
//
// M. Gautier, W. Khalil, "Exciting trajectories for the identification of base inertial
// parameters of robots", Int. J. Robotics Research 11 (1992).

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/studies/excitation/axis_limits.h"

namespace mjdiag {

struct JointMotionOptions {
  /// In the place of what the measured motion does, of a joint by name: positions, velocity,
  /// acceleration and force; what is not given (AxisLimits::kNone) stays.
  std::map<std::string, AxisLimits> limits;
  /// Of the series [Hz]; 0: where a sine that keeps the limit of velocity comes to that of
  /// acceleration, of the joint with the lowest.
  double highest_frequency = 0.0;
  int rounds = 2000;  ///< of eight motions each
  std::uint64_t seed = 1;
  /// @param condition  of the best motion so far
  std::function<void(double fraction, double condition)> progress;
  /// Whether to end with what there is; from any thread.
  std::function<bool()> stop;
};

struct JointMotionDesign {
  std::vector<std::string> joints;
  std::vector<std::string> joint_units;  ///< "rad" or "m"
  std::vector<std::string> numbers;      ///< that can be told
  std::vector<std::string> units;        ///< of every number
  Eigen::Index untold = 0;  ///< further ones that no motion tells from those
  Eigen::VectorXd before;   ///< standard deviations, measured motion
  Eigen::VectorXd after;    ///< of the design, as long as that
  double condition_before = 0.0;
  double condition_after = 0.0;
  double highest_frequency = 0.0;   ///< [Hz]
  Eigen::VectorXd noise;            ///< of every joint [N, N m]
  double bandwidth = 0.0;           ///< of the noise [Hz]
  std::vector<AxisLimits> limits;   ///< of every joint
  std::vector<AxisLimits> peaks;    ///< of the design
  double sample_time = 0.0;         ///< [s]
  Eigen::MatrixXd position_before;  ///< joints x samples
  Eigen::MatrixXd position;         ///< joints x samples
  bool stopped = false;

  double Gain() const { return condition_before / condition_after; }
  /// Where the joints go, for their controller to follow.
  Record Motion() const;
};

/// InputError on joints that are limited and not there, on limits of jerk and snap, or that
/// the plant cannot keep, or a record that does not say where the joints are. NumericalError if the measured
/// motion does not tell the numbers apart.
JointMotionDesign DesignJointMotion(const Machine& machine, const MeasuredRun& run,
                                    const JointMotionOptions& options);

}  // namespace mjdiag
