#pragma once
// A diagnosis inside the control callback.

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class MonitorObserver : public TickObserver {
 public:
  /// Neither is owned.
  explicit MonitorObserver(DiagnosisMonitor& monitor) : monitor_(monitor) {}
  explicit MonitorObserver(DiagnosisRecording& recording)
      : monitor_(recording.monitor), recorder_(&recording.recorder) {}

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    monitor_.Add(outputs, inputs);
    if (recorder_ != nullptr) recorder_->Add(monitor_);
  }

 private:
  DiagnosisMonitor& monitor_;
  MonitorRecorder* recorder_ = nullptr;
};

/// A run that an observer watches, of the plant or of its linear model.
inline Record RunWith(const Machine& machine, const Excitation& excitation,
                      TickObserver& observer, RunOptions options, bool linear) {
  options.observer = &observer;
  return linear ? SimulateLinear(machine, excitation, options)
                : Simulate(machine, excitation, options);
}

}  // namespace mjdiag
