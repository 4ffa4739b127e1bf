#pragma once
// What another machine does otherwise in every tick along the path of one, as columns
// (column.h): the exact derivatives of a fitted model by its coordinates, what leaving out a
// member would do, and what the size of the physics step makes.

#include <vector>

#include "mjdiag/discovery/blocks/column.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct OtherMachine {
  Machine machine;
  double step = 1.0;  ///< by which the difference is divided
};

/// Of each, its tick less that of the machine of the path, from where the path is. Both read
/// what they read there.
std::vector<Column> TickColumns(const Machine& machine, const MeasuredRun& run,
                                const FilterPath& path,
                                const std::vector<OtherMachine>& others);

}  // namespace mjdiag
