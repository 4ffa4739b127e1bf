#pragma once
// Effects to be found: drawn at random, and put into a simulated measurement of a machine
// that is its model otherwise.

#include <mujoco/mujoco.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"
#include "mjdiag/studies/hidden_case.h"

namespace mjdiag {

/// The types of run number `run`: one after the other of the registry.
std::vector<std::string> TypesOfRun(int run, int causes);

/// A case with these causes, of which nothing else is unknown; `seed` draws the noise.
HiddenCase MakeCase(const Machine& machine, const std::vector<Cause>& truth,
                    std::uint64_t seed);

/// The type of all fault parameters.
inline constexpr const char* kFaultType = "fault";

/// The sites of an effect, or of all fault parameters; none of noise.
std::vector<Candidate> SitesOf(const Machine& machine, const std::string& type);

/// Noise of one of the sensors.
Cause DrawNoise(const Channels& channels, Random& random);

/// Effects of those types (their names, or "fault" for a fault parameter) at random sites,
/// with random shapes. Each adds a sum of squares to the scaled innovations of a run that is
/// drawn evenly in its logarithm, from 200 (14 standard deviations) to 1e8. They are drawn
/// again until each adds about the least that no amplitudes of the others explain: two that
/// cancel, or are each other's image on this motion, are one. The same seed, the same
/// effects.
std::vector<Cause> DrawEffects(const Machine& machine,
                               const std::vector<std::string>& types,
                               std::uint64_t seed);

/// "coulomb_friction@X: force = 2; zeta_x = 1.2", "nothing".
std::string ListOf(const std::vector<Cause>& causes);

/// Of every sensor, what a machine with those changes is off on a motion that was
/// measured with noise and without, over the noise; none where it cannot be run.
std::vector<double> UnseenRatios(const Machine& machine, const Changes& changes,
                                 const Record& unseen, const Record& clean);

}  // namespace mjdiag
