#include "mjdiag/plugin/design/tolerant_run.h"

#include "mjdiag/plugin/design/monitor_observer.h"

namespace mjdiag {

TolerantRun RunTolerantly(const Machine& machine, const PreparedDiagnosis& prepared,
                          const TolerancePlan& plan, Eigen::Index samples,
                          RunOptions options,
                          const std::function<Record(const RunOptions&)>& run) {
  DiagnosisRecording recording = BeginDiagnosis(machine, prepared, samples);
  MonitorObserver watched(recording);
  FaultTolerance tolerance(plan, recording.monitor, watched);
  options.observer = &tolerance;
  options.reconfiguration = &tolerance.reconfiguration();
  TolerantRun made;
  made.record = run(options);
  recording.Finish();
  made.diagnosis = ConcludeWithLog(recording);
  made.faults = Summarise(tolerance.reconfiguration(), machine.setup());
  for (const AxisCorrection& axis : tolerance.reconfiguration().corrections()) {
    made.gains.push_back(axis.gain);
  }
  return made;
}

}  // namespace mjdiag
