#pragma once
// Moves (moves.h) by the forces that a machine lacks (disturbance_map.h), behind what the
// best of them leaves: what it leaves is found again about it.

#include <vector>

#include "mjdiag/discovery/regression/moves.h"

namespace mjdiag {

/// Parameters as of MovesOf.
Moves ForceMovesOf(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, std::vector<Block>& blocks,
                   const std::vector<Term>& terms, Looked looked);

}  // namespace mjdiag
