#include "mjdiag/plugin/design/diagnosis.h"

#include <cmath>

#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/design/robust_design.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;

DiagnosisDesign FiltersOf(const Machine& machine, const DiagnosisSource& source,
                          const Excitation& motion) {
  if (!source.filters.empty()) {
    DiagnosisDesign design = ReadFilters(source.filters);
    RequireSameMachine(source.filters.string(), design, machine.setup());
    return design;
  }
  if (!source.robust.empty()) {
    return DesignRobustFilters(machine, source.robust, motion, source.baseline);
  }
  return DesignFilters(machine);
}

/// First sample of the horizon at the end of the record.
Index HorizonStart(const DiagnosisDesign& design, const Record& record) {
  const double horizon = design.options.horizon;
  if (horizon == 0.0) return 0;
  if (horizon > record.duration() * (1.0 + 1e-9)) {
    throw InputError(
        "horizon", FormatQuantity(horizon, "s"),
        "no more than the record's " + FormatQuantity(record.duration(), "s"));
  }
  return record.samples() - std::lround(horizon / record.sample_time());
}

}  // namespace

bool NeedsMotion(const DiagnosisSource& source) {
  return source.baseline || !source.robust.empty();
}

void RequireSameMachine(const std::string& what, const DiagnosisDesign& design,
                        const Setup& setup) {
  if (design.outputs != ChannelsOf(setup.channels.sensors) ||
      design.inputs != ChannelsOf(setup.channels.actuators)) {
    throw InputError(what, "its channels are not those of '" + setup.name + "'",
                     "filters designed for this setup");
  }
  if (std::abs(design.sample_time() * setup.rates.control - 1.0) > 1e-9) {
    throw InputError(
        what, "made for a tick of " + FormatQuantity(design.sample_time(), "s"),
        "the control tick of the setup, " + FormatQuantity(setup.rates.tick(), "s"));
  }
}

PreparedDiagnosis PrepareDiagnosis(const Machine& machine,
                                   const DiagnosisSource& source,
                                   const Excitation& motion) {
  if (source.filters.empty() && !NeedsMotion(source) && machine.setup().calibration) {
    // Limits that hold for the healthy runs stand beside what was learned from them.
    DiagnosisSource beside = source;
    beside.filters = machine.setup().folder / kCalibratedFilters;
    if (std::filesystem::exists(beside.filters)) {
      return PrepareDiagnosis(machine, beside, motion);
    }
  }
  PreparedDiagnosis prepared;
  prepared.design = FiltersOf(machine, source, motion);
  prepared.nominal = source.nominal;
  if (source.filters.empty()) {
    prepared.design.linear = source.nominal.linear;
  } else if (prepared.design.linear) {
    prepared.nominal.linear = true;
  }
  prepared.nominal.progress = nullptr;  // belongs to this call
  NominalRuns runs = source.nominal;
  runs.linear = prepared.nominal.linear;
  if (source.baseline) {
    prepared.motion = motion;
    prepared.baseline = ResidualBaseline(prepared.design, machine, motion, runs);
    runs.seed += static_cast<std::uint64_t>(runs.runs);
    prepared.design.limits =
        CalibrateLimits(prepared.design, machine, motion, prepared.baseline, runs);
  } else if (!prepared.design.limits.known) {
    prepared.design.limits = CalibrateLimits(prepared.design, machine, runs);
  }
  return prepared;
}

DiagnosisRecording BeginDiagnosis(const Machine& machine,
                                  const PreparedDiagnosis& prepared, Index capacity) {
  DiagnosisRecording recording(prepared.design, capacity, prepared.baseline);
  if (auto twin = MakeTwinEstimator(machine, prepared.nominal.linear)) {
    recording.monitor.Follow(std::move(twin));
  }
  return recording;
}

Diagnosis Diagnose(const Machine& machine, const PreparedDiagnosis& prepared,
                   const Record& record) {
  const Index from = HorizonStart(prepared.design, record);
  DiagnosisRecording recording = BeginDiagnosis(machine, prepared, record.samples());
  recording.monitor.RegressFrom(from);
  Run(recording, record);
  return ConcludeWithLog(recording);
}

Diagnosis ConcludeWithLog(const DiagnosisRecording& recording) {
  Diagnosis diagnosis;
  diagnosis.log = recording.recorder.Log();
  diagnosis.result = Conclude(recording.monitor, diagnosis.log);
  return diagnosis;
}

DiagnosedRun DiagnoseRun(const Machine& machine, const PreparedDiagnosis& prepared,
                         const Excitation& motion, const Changes& faults,
                         RunOptions options) {
  DiagnosisRecording recording = BeginDiagnosis(machine, prepared, motion.samples());
  MonitorObserver observer(recording);
  Record record = RunWith(machine.With(faults), motion, observer, std::move(options),
                          prepared.nominal.linear);
  recording.Finish();
  return {std::move(record), ConcludeWithLog(recording)};
}

}  // namespace mjdiag
