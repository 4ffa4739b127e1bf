#pragma once
// A discovery as Python has it: its answer, and the machine that it was asked of.

#include <string>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "python/machine.h"

namespace mjdiag::python {

struct DiscoveryObject {
  MachineObject machine;  ///< the nominal one
  Discovery discovery;
};

}  // namespace mjdiag::python
