#pragma once
// A diagnosis inside the control callback.

#include "mjdiag/diagnosis/monitor.h"
#include "mjdiag/plugin/simulation.h"

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

}  // namespace mjdiag
