#pragma once
// Effects to be found: drawn at random, put into a simulated measurement, sealed. What
// has to find them sees the record and the nominal setup only.

#include <mujoco/mujoco.h>

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// A measurement with something hidden in it.
struct HiddenCase {
  std::vector<Cause> truth;
  Record record;        ///< of the default trajectory, with sensor noise
  Record unseen;        ///< of another trajectory, with noise
  Record unseen_clean;  ///< the same without noise
};

/// How large hidden effects are: the sum of squares that an effect adds to the scaled
/// innovations of a run, drawn evenly in its logarithm. Ten standard deviations are
/// 100.
struct HiddenSize {
  double least = 200.0;
  double most = 1e8;
};

/// A case with these causes; `seed` draws the noise.
HiddenCase MakeCase(const Machine& machine, const std::vector<Cause>& truth,
                    std::uint64_t seed);

/// The type of all fault parameters.
inline constexpr const char* kFaultType = "fault";

/// The sites of an effect, or of all fault parameters; none of noise.
std::vector<Candidate> SitesOf(const Machine& machine, const std::string& type);

/// Noise of one of the sensors.
Cause DrawNoise(const Channels& channels, Random& random);

/// One effect of that type (its name, or "fault" for a fault parameter) at a random
/// site, with random shape and a size drawn from `size`. The same seed, the same
/// effect.
Cause DrawEffect(const Machine& machine, const std::string& type,
                 const HiddenSize& size, std::uint64_t seed);

/// Several effects at once, each drawn as above, and drawn again until each adds at
/// least `size.least` that no amplitudes of the others explain: two that cancel, or are
/// each other's image on this motion, are one.
std::vector<Cause> DrawEffects(const Machine& machine,
                               const std::vector<std::string>& types,
                               const HiddenSize& size, std::uint64_t seed);

/// "coulomb_friction@X: force = 2; zeta_x = 1.2", "nothing".
std::string ListOf(const std::vector<Cause>& causes);

/// Of every sensor, what a machine with those changes is off on a motion that was
/// measured with noise and without, over the noise; none where it cannot be run.
std::vector<double> UnseenRatios(const Machine& machine, const Changes& changes,
                                 const Record& unseen, const Record& clean);

}  // namespace mjdiag
