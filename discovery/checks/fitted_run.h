#pragma once
// What a machine does along a record when its resonances are where the record has them, for
// the checks of it: near enough to tell what they explain, not to report them.
//
// The logarithms of the stiffnesses (of masses, inertias and gears where there are none) are
// fitted to the readings, and in closed loop to the inputs, as differences over a few samples
// (lag_trend.h), beside a constant, a gain, a lag and a drift of each, by Gauss and Newton.
// Each is known beforehand as DoubtOf says, and the noise is what is left. Where a resonance
// is off by a turn along the record there are many minima: the stiffnesses are moved together
// first, to the best of thirty steps between 0.05 and 20 %.

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// @param nominal  the machine as given along the record, from its readings
/// @return the record simulated with the numbers fitted, or `nominal`
Record FittedRun(const Machine& machine, const Record& measured, const Record& nominal);

}  // namespace mjdiag
