#include "controlled_machine.h"

#include "guard.h"

namespace mjdiag {

void Relay::SendTo(mjdiag_monitor& monitor) {
  if (monitor_ != &monitor && monitor_ != nullptr && monitor_->object != nullptr &&
      monitor_->object->source() == this) {
    throw InputError("instance", "another monitor watches it", "one without a monitor");
  }
  monitor_ = &monitor;
}

void Relay::OnTick(std::span<const double> outputs,
                   std::span<const double> inputs) noexcept {
  if (monitor_ == nullptr || monitor_->object == nullptr) return;
  const Inside inside;
  monitor_->object->Take(this, outputs, inputs);
}

}  // namespace mjdiag
