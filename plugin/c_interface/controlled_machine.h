#pragma once
// A machine of a program in C that mjdiag controls, and the monitor that watches it.

#include <mujoco/mujoco.h>

#include <memory>

#include "mjdiag.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "watch.h"

struct mjdiag_monitor {
  std::unique_ptr<mjdiag::Watch> object;
};

namespace mjdiag {

/// Hands the ticks of an instance to a monitor, if one watches it.
class Relay : public TickObserver {
 public:
  /// InputError if an open monitor watches already.
  void SendTo(mjdiag_monitor& monitor);
  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override;

 private:
  mjdiag_monitor* monitor_ = nullptr;
};

struct ControlledMachine {
  const mjModel* model;
  mjData* data;
  Setup setup;
  Relay relay;
  std::unique_ptr<Instance> instance;  // refers to the relay
};

}  // namespace mjdiag

struct mjdiag_instance {
  std::unique_ptr<mjdiag::ControlledMachine> object;
};
