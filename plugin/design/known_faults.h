#pragma once
// The diagnosis of somebody who knows: it tells a reconfiguration the true faults of a
// run, some time after they have appeared. It shows what the controllers make of
// estimates, apart from how the estimates are made.

#include <vector>

#include "mjdiag/controllers/reconfiguration.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

class KnownFaults final : public TickObserver {
 public:
  /// @param faults  late faults of the run
  /// @param delay   from the time of each until it is known [s]
  /// @param sd      that is told of every deviation
  /// InputError on a fault without a remedy.
  KnownFaults(Reconfiguration& reconfiguration, const Setup& setup,
              const std::vector<LateFault>& faults, double delay, double sd);

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override;

 private:
  struct Event {
    Eigen::Index tick = 0;
    Eigen::Index remedy = 0;
    double deviation = 0.0;
    Eigen::Index first_tone = 0;
    Eigen::Index tones = 0;
  };

  Reconfiguration& reconfiguration_;
  FaultEstimates estimates_;
  std::vector<Event> events_;  // in the order of time
  std::size_t next_ = 0;
  Eigen::Index ticks_ = 0;
};

}  // namespace mjdiag
