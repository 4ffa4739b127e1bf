#pragma once
// How well a machine is known, learned from measured runs of which one is sure that it
// was healthy. The numbers of its plant are as well known beforehand as the plant says,
// or their kind usually is; what all runs together say of them is added (run_pass.h).
// What a fault then has for a standard deviation beside m such runs of a comparable
// motion is sqrt(1 + 1/m) times that of an exactly known plant.
//
// - Sensor noise is that of the innovations from tick to tick,
//   r = 1.4826 median |e[k] - e[k-1]| / sqrt(2), which slow errors of the model leave
//   as it is.
// - Force noise, that is what the model does not know, is the least of a ladder
//   (kTwinBandwidths) with which no block of any run is more of a surprise than chance
//   lets expect, for that is what the estimator goes by. Where there is none, all that
//   the stiffest leaves is noise of the sensors. From then on, blocks may be as
//   surprising as twice the innovations of the worst one make them (as limits of
//   residuals are twice what healthy runs show).
// - Errors of a model are alike from one tick to the next, which no innovation shows.
//   Every part of the runs is therefore diagnosed like a run of its own; what the parts
//   say of faults that are not there, beyond noise, is uncertainty of the model
//   (model_uncertainty.h).
// - Limits of residuals are those of the measured runs, and of simulated ones of plants
//   drawn from what is known.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct CalibratedRecord {
  double nis = 1.0;  ///< of the twin with that calibration
};

struct CalibrationReport {
  Calibration calibration;
  Eigen::VectorXd prior_sd;  ///< of the logarithms of the numbers, before any record
  std::vector<CalibratedRecord> records;
  /// Numbers that are far from what was known of them: no healthy runs of this machine,
  /// or a plant that is not this machine's.
  std::vector<std::string> doubts;
};

struct CalibrateOptions {
  bool linear = false;
  std::function<void(double)> progress;  ///< part of the work that is done
};

/// InputError if a record lacks a channel or has another rate than the setup, or the
/// plant has no numbers.
CalibrationReport Calibrate(const Machine& machine, const std::vector<Record>& records,
                            const CalibrateOptions& options);

/// The machine with what was learned of it, for a diagnosis: as Machine(setup) makes it of a
/// setup with that calibration, changes and all.
Machine CalibratedMachine(const Machine& machine, const Calibration& calibration);

/// Filters of a calibrated machine with limits that hold for those healthy records.
DiagnosisDesign CalibratedFilters(const Machine& calibrated,
                                  const std::vector<Record>& records,
                                  const NominalRuns& runs);

}  // namespace mjdiag
