#pragma once
// The answer of a diagnosis: is something wrong, since when, which fault and how large.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_recording.h"

namespace mjdiag {

struct FaultVerdict {
  std::string name;
  double value = 0.0;  ///< of the fault parameter: 1 healthy; disturbances: 0 healthy
  double deviation = 0.0;  ///< from healthy
  double sd = 0.0;
  Interval ci95;
  bool detected = false;
  /// Deviation from which on it would be named, alone, and from which on with ever more
  /// healthy records of ever other motions; NaN of a disturbance, and without a twin.
  double alarm = std::numeric_limits<double>::quiet_NaN();
  double best_alarm = std::numeric_limits<double>::quiet_NaN();
};

struct DiagnosisResult {
  std::string setup;
  Eigen::Index samples = 0;
  double sample_time = 0.0;  ///< [s]
  bool detected = false;     ///< by the residual, an estimate or the disturbance
  std::optional<double> first_detection;  ///< of the residual [s]
  /// When the windowed mean of |r| left its limit: not a passing disturbance [s].
  std::optional<double> lasting;
  Interval residual;  ///< extremes of r
  Interval limits;    ///< Eq. 20
  std::vector<FaultVerdict> faults;
  /// The faults come from the machine's twin, told apart all together; else one by one
  /// from its residuals, where a large one leaks into the others.
  bool by_twin = false;
  /// Of the twin: squared innovations over what is expected of them, 1 where it explains
  /// all that it sees.
  double nis = 1.0;
  /// Healthy records that tell how uncertain its model is (model_uncertainty.h); 0: it is
  /// not.
  int model_records = 0;
  DisturbanceReport disturbance;
};

/// An estimate as healthy runs have it (DiagnosisLimits::estimates): without the part
/// that they show, too, and not surer than they agree on.
struct CalibratedEstimate {
  double deviation = 0.0;  ///< from healthy
  double sd = 0.0;
  bool usual = false;  ///< within the limits of healthy runs
};
/// @param sd  of the estimate of that fault, from the noise of the sensors
CalibratedEstimate Calibrate(const DiagnosisDesign& design, Eigen::Index fault,
                             double deviation, double sd);

/// Every fault as the monitor sees it now, at any tick. Without a twin none is detected
/// before the motion has told all of them apart.
std::vector<FaultVerdict> JudgeFaults(const DiagnosisMonitor& monitor);

/// What a stretch of a run says of disturbances, less what the faults that are detected put
/// into it.
/// @param skipped  samples at its begin, in which filters settle that began with it
/// InputError as AnalyseDisturbance.
DisturbanceReport AnalyseStretch(const DiagnosisDesign& design, const MonitorLog& log,
                                 const std::vector<FaultVerdict>& faults,
                                 Eigen::Index skipped);

/// From a monitor at the end of its run, finished (DiagnosisMonitor::Finish).
/// @param log  what a recorder kept of the whole run
/// InputError names the faults that the motion does not tell apart.
DiagnosisResult Conclude(const DiagnosisMonitor& monitor, const MonitorLog& log);

DiagnosisResult Conclude(const DiagnosisRecording& recording);

}  // namespace mjdiag
