#pragma once
// Is every channel in the unit that the setup says, and does it count in the direction
// of the plant? A wrong unit or sign would be explained by causes that no machine has.
//
//   wrong units   a channel of the shape of what it should be (correlation) but about
//                 10^3, 10^6, 10^-3, 10^-6 or, for angles, 180 / pi or pi / 180 times it
//                 (within a factor of 2). Degrees of inputs, and of readings in open
//                 loop that move in less than two octaves, are within 10 %: there are
//                 machines with such a factor in between.
//   flipped sign  a channel of that shape but about -1 times it, or one of these factors
//
// In closed loop readings are held against their references and, where these are not
// followed, against the nominal plant on the measured reference; inputs against those of
// that plant. Where the size or the phase of a motion may also be that of a weak loop the
// controllers tell: they command the recorded input for the readings that they saw, as
// these are in the record or without the mistake, on whatever plant.
//
// In open loop readings are held against the nominal plant under the measured input.
// Beside other resonances a machine moves against its model at some frequencies; one
// whose sign is flipped does at all, by the same factor (Likeness::broad). A plant that
// is not stable, or that half of the input moves in another way, as an arm does that falls
// for want of friction and controllers, has neither size nor sign: chance says where it is.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Whether all readings are about their references, so that runs may start from them.
/// InputError on readings that are the references times a mistake, and on inputs that
/// are minus what the controllers command. True in open loop.
bool CheckAgainstReferences(const Setup& setup, const Record& measured);

/// @param simulated  the nominal plant along the record (NominalRun)
/// InputError names the channel, the factor and what was probably mistaken.
void CheckAgainstPlant(const Machine& machine, const Record& measured,
                       const Record& simulated);

}  // namespace mjdiag
