#include "mjdiag/plugin/design/known_faults.h"

#include <algorithm>

#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;

KnownFaults::KnownFaults(Reconfiguration& reconfiguration, const Setup& setup,
                         const std::vector<LateFault>& faults, double delay, double sd)
    : reconfiguration_(reconfiguration), estimates_(reconfiguration.MakeEstimates()) {
  estimates_.sd.setConstant(sd);
  for (const LateFault& late : faults) {
    const LateFault known{late.fault, late.time + delay};
    Event event{.tick = TickOf(known, reconfiguration.options().sample_time)};
    for (const FaultRemedy& remedy : reconfiguration.remedies()) {
      event.tones = static_cast<Index>(remedy.tones.size());
      if (remedy.fault == late.fault.name) break;
      ++event.remedy;
      event.first_tone += 2 * event.tones;
    }
    if (event.remedy == estimates_.deviation.size()) {
      throw InputError("fault " + late.fault.name, "has no remedy",
                       "one of the faults of the plan");
    }
    const double healthy = IsDisturbance(setup, late.fault.name) ? 0.0 : 1.0;
    event.deviation = late.fault.value - healthy;
    events_.push_back(event);
  }
  std::stable_sort(events_.begin(), events_.end(),
                   [](const Event& a, const Event& b) { return a.tick < b.tick; });
}

void KnownFaults::OnTick(std::span<const double> /*outputs*/,
                         std::span<const double> /*inputs*/) noexcept {
  for (; next_ < events_.size() && events_[next_].tick <= ticks_; ++next_) {
    const Event& event = events_[next_];
    estimates_.deviation[event.remedy] = event.deviation;
    for (Index i = 0; i < event.tones; ++i) {
      // Disturbances of a run are sines from its start on.
      estimates_.tones[event.first_tone + 2 * i] = event.deviation;
    }
  }
  reconfiguration_.Observe(estimates_);
  ++ticks_;
}

}  // namespace mjdiag
