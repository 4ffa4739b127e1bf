#pragma once
// What a machine does along a record when its numbers are what the record says, for the
// checks of it: near enough to tell what they explain, not to report them.
//
// The numbers' logarithms are fitted to the readings (and in closed loop to the inputs),
// as differences over a few samples (lag_trend.h), beside a constant lag and a constant
// of each, by Gauss and Newton; each is known beforehand as DoubtOf says, and the noise is
// what is left. A resonance that is off by more than a turn along the record has many
// minima: the stiffnesses are moved together first, to the best of thirty steps between
// 0.05 and 20 %.

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// @param nominal  the machine as given along the record, from its readings
/// @return the record simulated with the numbers fitted, or `nominal`
Record FittedRun(const Machine& machine, const Record& measured, const Record& nominal);

}  // namespace mjdiag
