#pragma once
// A run of known length under diagnosis: a monitor with a recorder behind it, fed tick
// by tick or from a record.

#include <Eigen/Core>
#include <span>

#include "mjdiag/diagnosis/monitor.h"
#include "mjdiag/diagnosis/monitor_recorder.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct DiagnosisRecording {
  /// @param capacity  ticks that the recorder has room for
  /// @param baseline  see DiagnosisMonitor
  DiagnosisRecording(const DiagnosisDesign& design, Eigen::Index capacity,
                     Eigen::MatrixXd baseline = {});

  /// One control tick, as DiagnosisMonitor::Add. Does not allocate, lock, throw or do
  /// I/O.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept {
    monitor.Add(outputs, inputs);
    recorder.Add(monitor);
  }
  void Add(std::span<const double> outputs, std::span<const double> inputs,
           std::span<const bool> measured, bool gap) noexcept {
    monitor.Add(outputs, inputs, measured, gap);
    recorder.Add(monitor);
  }

  /// At the end of a run (DiagnosisMonitor::Finish).
  void Finish() noexcept {
    monitor.Finish();
    recorder.AddFinal(monitor);
  }

  DiagnosisMonitor monitor;
  MonitorRecorder recorder;
};

/// Feeds the record of a run to a monitor, sample by sample, and finishes. What was not
/// measured is not judged. InputError
/// if a channel is missing or the record is sampled at another rate than the filters.
void Run(DiagnosisMonitor& monitor, const Record& record);
void Run(DiagnosisRecording& recording, const Record& record);
/// The same of a part of a run, which goes on: Finish ends it.
void RunPart(DiagnosisRecording& recording, const Record& part);

/// The recording of a whole record.
/// @param baseline  see DiagnosisMonitor
/// @param from      first sample that is regressed
DiagnosisRecording RecordDiagnosis(const DiagnosisDesign& design, const Record& record,
                                   const Eigen::MatrixXd& baseline = {},
                                   Eigen::Index from = 0);

}  // namespace mjdiag
