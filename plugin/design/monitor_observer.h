#pragma once
// A diagnosis inside the control callback.

#include "mjdiag/diagnosis/monitor.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class MonitorObserver : public TickObserver {
 public:
  /// The monitor is not owned.
  explicit MonitorObserver(DiagnosisMonitor& monitor) : monitor_(monitor) {}

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    monitor_.Add(outputs, inputs);
  }

 private:
  DiagnosisMonitor& monitor_;
};

/// A run that the monitor watches, of the plant or of its linear model.
inline void RunWith(DiagnosisMonitor& monitor, const Machine& machine,
                    const Excitation& excitation, RunOptions options, bool linear) {
  MonitorObserver observer(monitor);
  options.observer = &observer;
  linear ? SimulateLinear(machine, excitation, options)
         : Simulate(machine, excitation, options);
}

}  // namespace mjdiag
