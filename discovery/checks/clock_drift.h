#pragma once
// Were two channels of a record sampled by the same clock? The lag of each behind the
// simulated plant (lag_trend.h) of clocks that drift apart differs more and more with
// time.
//
// So does that of a resonance whose frequency is off: its phase goes astray after every
// strike. What tells the two apart is evidence of three kinds, all of which a drift has to
// give before a record is refused for it:
//   everywhere  the lag of the whole record grows;
//   acting      so it does in the tenths alone in which something acts on the machine: what
//               rings on by itself has no other clock to be late against;
//   no number   so it does behind the plant whose numbers are moved to where the record
//               has them (fitted_run.h).
// Where the first is there and the second cannot be had, that is said and not refused.

#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// @param simulated  the nominal plant along the record, from its readings, without noise
/// @return what cannot be told, sentences for people
/// InputError names two channels whose clocks drift apart: in closed loop the reading
/// and the input or else the reference of an axis, in open loop a reading and the
/// input.
std::vector<std::string> CheckClocks(const Machine& machine, const Record& measured,
                                     const Record& simulated);

}  // namespace mjdiag
