#pragma once
// Which motion next: one within the limits of the axes whose run tells most of what is
// wanted, for the linear machine in its closed loop. It is the moves of a trajectory of the
// setup, all of them a share as large, and tones beside them (tone_shares.h). What tones
// tell is known of each one by itself; how large all of them may be together is then found
// along the whole motion, and last in the nonlinear machine.
//
// Mehra, "Optimal input signals for parameter estimation in dynamic systems", IEEE Trans.
// Autom. Control 19 (1974); Swevers et al., "Optimal robot excitation and identification",
// IEEE Trans. Robot. Autom. 13 (1997), for the Fourier series.

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/studies/excitation/axis_limits.h"

namespace mjdiag {

struct MotionDesignOptions {
  /// Fault parameters and numbers of the plant; none: all fault parameters.
  std::vector<std::string> wanted;
  /// In the place of what the default motion does, of an axis by name; what is not given
  /// (AxisLimits::kNone) stays.
  std::map<std::string, AxisLimits> limits;
  double highest_frequency = 0.0;  ///< of tones [Hz]; 0: a quarter of the control rate
  std::string name = "excite";     ///< of the trajectory
  /// @param gain  of the best motion so far, as MotionDesign::Gain
  std::function<void(double fraction, double gain)> progress;
  /// Whether to end with what there is; from any thread.
  std::function<bool()> stop;
};

struct MotionDesign {
  Trajectory trajectory;
  double share_of_moves = 0.0;
  std::string moves_of;               ///< trajectory whose moves these are; empty: none
  std::vector<std::string> unknowns;  ///< all, those that were wanted among them
  std::vector<bool> wanted;
  Eigen::VectorXd before;          ///< standard deviations, default motion
  Eigen::VectorXd after;           ///< of the design, as long as that
  std::vector<AxisLimits> limits;  ///< of every axis
  std::vector<AxisLimits> peaks;   ///< of the design in the nonlinear machine
  Record run_before;               ///< of the nonlinear machine without noise
  Record run_after;
  bool stopped = false;

  /// Of the largest standard deviation that was wanted, before over after.
  double Gain() const;
};

/// InputError on a machine without controllers or trajectory, what is wanted or limited
/// that it does not have, or limits that not even a rest keeps. NumericalError if the
/// default motion does not tell the unknowns apart.
MotionDesign DesignMotion(const Machine& machine, const MotionDesignOptions& options);

}  // namespace mjdiag
