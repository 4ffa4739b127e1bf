#pragma once
// A machine in whose run faults appear, change and go: the machines that it is, one
// after the other.

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag {

/// What the machine becomes from a tick on.
struct MachineStage {
  Eigen::Index tick = 0;
  Machine machine;
  Eigen::Index ticks = 0;  ///< in so many of them, evenly; 0: at once
};

/// In the order of time, without that at the start; disturbances are left out. A value
/// is that of the fault parameter, whatever it was before. Faults may grow while others
/// appear or grow. One that grows is left where it is by a later change of the same
/// fault parameter, which begins there. InputError on an unknown name, on a time, growth
/// or value that is not finite and >= 0, on a change from 0, which is no factor, and on a
/// disturbance that grows.
std::vector<MachineStage> StagesOf(const Machine& machine,
                                   std::span<const LateFault> faults);

/// From "<name>=<value>", there from the start, or "<name>=<value>@<seconds>"; InputError
/// says what is malformed.
LateFault ParseLateFault(std::string_view text);

/// The first tick of a late fault.
Eigen::Index TickOf(const LateFault& fault, double sample_time);

}  // namespace mjdiag
