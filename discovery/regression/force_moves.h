#pragma once
// Moves (moves.h) by the forces that a machine lacks (missing_force_map.h): as if what they
// leave did not last, and then as long as what the best of them leaves does.

#include <vector>

#include "mjdiag/discovery/regression/moves.h"

namespace mjdiag {

/// Both, the second first. Parameters as of MovesOf.
std::vector<Moves> ForceMovesOf(const Machine& machine, const MeasuredRun& run,
                                const FilterPath& path, std::vector<Block>& blocks,
                                const std::vector<Term>& terms, bool at_every_shape);

}  // namespace mjdiag
