#pragma once
// From a setup and its plant to a diagnosis: filters from the linearised plant, limits
// from nominal runs.

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/residuals/residual_bank.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// How residual generators of this plant are made: timing, degree, denominator, sensor
/// noise and unknown forces of the setup. InputError names an unknown joint.
SynthesisOptions SynthesisOf(const Machine& machine);

/// z = [y; u] of a record as deviations from rest, nz x samples.
Eigen::MatrixXd Signals(const DiagnosisDesign& design, const Record& record);

/// A healthy run of the plant's linear part without noise: the default trajectory, or
/// random inputs where the setup has no controllers.
Record LinearRun(const Machine& machine);
/// The same with another motion.
Record LinearRun(const Machine& machine, const Excitation& motion);

/// Of which order the residuals are, and how many there are.
struct ResidualSettings {
  ResidualOrder residual;
  int count = 1;  ///< 0: all of the null space
};

/// Residual generator, prefilters and disturbance filter of the healthy plant, without
/// limits. The parity relation is the one that sees all faults best on LinearRun.
DiagnosisDesign DesignFilters(const Machine& machine, const ResidualSettings& settings);
/// With the residuals that the setup asks for.
DiagnosisDesign DesignFilters(const Machine& machine);

/// The runs from which limits and baselines come.
struct NominalRuns {
  bool linear = false;
  int runs = 5;               ///< of the default trajectory, or of the motion given
  std::uint64_t seed = 1001;  ///< of the first run; the others count up
  std::function<void(double fraction)> progress;
};

/// Limits (Eq. 20, 21, 29, 30) from one run of every trajectory that the setup lists
/// for thresholds and some of its default one.
DiagnosisLimits CalibrateLimits(const DiagnosisDesign& design, const Machine& machine,
                                const NominalRuns& options);

/// Limits for one motion, with its baseline subtracted in every run ([AB383],
/// section A.6); the runs do not share seeds with those of the baseline.
DiagnosisLimits CalibrateLimits(const DiagnosisDesign& design, const Machine& machine,
                                const Excitation& excitation,
                                const Eigen::MatrixXd& baseline,
                                const NominalRuns& options);

/// Mean residuals of the healthy plant over this motion, n x samples.
Eigen::MatrixXd ResidualBaseline(const DiagnosisDesign& design, const Machine& machine,
                                 const Excitation& excitation,
                                 const NominalRuns& options);

/// Limits that hold for measured healthy records and for simulated runs of the same
/// motions on plants that are drawn from what the calibration of the machine knows.
DiagnosisLimits LimitsOfRecords(const DiagnosisDesign& design, const Machine& machine,
                                const std::vector<Record>& records,
                                const NominalRuns& options);

}  // namespace mjdiag
