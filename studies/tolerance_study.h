#pragma once
// What fault-tolerant control is good for and that it does no harm: gain margins, the
// closed loop and runs over the range of the faults, and runs in which faults appear
// midway.

#include "mjdiag/plugin/design/fault_tolerance.h"
#include "mjdiag/studies/machine_study.h"
#include "mjdiag/studies/plan/study_plan.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// A run in which faults appear, beside the same run without them and the same run
/// without a correction; all with the same noise.
struct ToleratedRun {
  /// Of the last repetition: rms of the tracking error over the healthy one, of the
  /// axis where it is worst.
  double uncorrected = 1.0;
  double corrected = 1.0;
  /// From the first fault until the tracking error of every axis stays within 1.1 times
  /// the healthy one [s], in windows of 50 ms; infinite: it does not. 0: never left.
  double recovery = 0.0;
  double since = 0.0;  ///< from the first fault to the first correction [s]
  /// How much larger than in either of the other runs the tracking error is at any time,
  /// in standard deviations of the noise of its sensor.
  double bump = 0.0;
};

/// Who tells what is wrong.
enum class Teller {
  kKnown,  ///< somebody who knows, 50 ms after it happens
  kTwin    ///< the diagnosis in the control callback
};

/// NumericalError if any of the runs diverges.
ToleratedRun TryTolerance(const Machine& machine, const TolerancePlan& plan,
                          const std::vector<SizedFault>& faults, double time,
                          Teller teller, bool linear, std::uint64_t seed);

}  // namespace mjdiag
