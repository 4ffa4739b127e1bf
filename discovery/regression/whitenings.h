#pragma once
// The filter of a path behind several noises (whitening.h): as it was found, and with smaller
// and smaller latent forces, for a model that is right deserves them.

#include <vector>

#include "mjdiag/discovery/regression/whitening.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// Smaller and smaller latent forces, the first as found.
std::vector<FilterNoise> NoisesFrom(const FilterNoise& found);

struct Whitenings {
  std::vector<FilterNoise> noises;
  std::vector<Whitening> behind;  ///< each of them

  std::vector<const RowMap*> maps() const {
    std::vector<const RowMap*> all;
    for (const Whitening& one : behind) all.push_back(&one);
    return all;
  }
};

/// @param path  has to outlive them
Whitenings WhiteningsOf(const FilterPath& path);

}  // namespace mjdiag
