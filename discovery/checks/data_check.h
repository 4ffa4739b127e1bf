#pragma once
// Can a measured record be judged at all? Bad data would be explained by causes that no
// machine has, so it is refused before anything is fitted to it.
//
// Refused with InputError, with n samples left after setup.compare.skip_samples:
//   too short     n < 64
//   missing       a sample that is NaN or infinite and not marked as not measured
//   saturated     a sensor that stays at exactly its largest or smallest value, at
//                 least 10 samples at a time, for more than 0.5 % of n, although it is
//                 noisy elsewhere and repeats less there, or should move there (by its reference in closed
//                 loop, by the simulated plant in open loop) and comes and goes at a
//                 steady speed
//   wrong units   and flipped signs: see unit_check.h
//   clock drift   see clock_drift.h
//
// Whatever a physical cause does has to pass: stiction holds a reading, but does not
// let it jump; a rest at the end of a stroke repeats a quantised reading, but not one
// with noise; a cause does not change a force a thousandfold and keep its shape.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// @return what one should know and can live with, sentences for people
/// InputError names the channel and what is wrong with it; also if the record lacks
/// what the replay needs (see ToMeasuredRun).
std::vector<std::string> CheckRecord(const Machine& machine, const Record& measured);

}  // namespace mjdiag
