#pragma once
// What a setup says about its diagnosis: the settings of [AB383], chapter 4.

#include <map>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/disturbance/disturbance_spectrum.h"
#include "mjdiag/diagnosis/residuals/residual_order.h"

namespace mjdiag {

/// The residual for the nonlinear machine.
struct RobustOptions {
  ResidualOrder residual{8, {8, 200.0}};  ///< a higher one leaves more to choose from
  int runs = 8;                           ///< nominal runs of the nonlinear plant
};

struct DiagnosisOptions {
  ResidualOrder residual;
  /// Residuals that the estimator uses; 0: the whole null space. The detector has one.
  int estimation_residuals = 1;
  /// Fault parameter -> c of Eq. 22; those that are left out: 1e-3.
  std::map<std::string, double> magnitudes;
  /// Joints with an unknown force to which the residuals have to be blind (B_d).
  std::vector<std::string> unknown_forces;

  double margin = 2.0;        ///< alpha of Eq. 21
  double false_alarms = 0.0;  ///< wanted probability a run instead of alpha; 0: none
  /// Nominal runs for the thresholds; empty: the default trajectory.
  std::vector<std::string> trajectories;
  double integral_window = 0.25;  ///< [s] of the mean of |r|

  double sampling = 0.0005;  ///< [s] between regressed samples
  double horizon = 0.0;      ///< [s] regressed at the end of a record; 0: all of it
  double forgetting = 0.0;   ///< [s] time constant inside the callback; 0: none

  Denominator disturbance_denominator{7, 750.0};  ///< Eq. 33
  int high_pass_order = 3;                        ///< Eq. 34
  double high_pass_cutoff = 100.0;                ///< [Hz]
  DisturbanceOptions disturbance;

  RobustOptions robust;
};

}  // namespace mjdiag
