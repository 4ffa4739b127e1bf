#pragma once
// What is put into a plant: faults of its own parameters, and effects that it lacks.

#include <vector>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/fault.h"

namespace mjdiag {

struct Changes {
  std::vector<Fault> faults;
  std::vector<PlacedEffect> effects;

  bool operator==(const Changes&) const = default;
};

}  // namespace mjdiag
