#pragma once
// What is put into a plant: numbers of it that are others than the file says, faults of
// its own parameters, and effects that it lacks.

#include <vector>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

struct Changes {
  std::vector<Fault> faults;
  std::vector<PlacedEffect> effects;
  NumberFactors numbers =
      {};  ///< first, so that effects add to the numbers as they are

  bool operator==(const Changes&) const = default;
};

}  // namespace mjdiag
