#pragma once
// Which experiment would discriminate between two hypotheses? Both are run, without
// noise, along the trajectories of the setup, as they are and slower, and the one is
// proposed in which their readings differ most, in units of the sensor noise.

#include <mujoco/mujoco.h>

#include <optional>
#include <string>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

struct DiscriminatingExperiment {
  std::string trajectory;  ///< name in the setup
  double slower = 1.0;     ///< times its limits of velocity (and powers of it above)
  /// Root of the sum of squares of the readings' difference over the sensor noise.
  double separation = 0.0;
};

/// None without controllers or trajectories in the setup, or if no run succeeds.
/// @param machine  with the measured noise of its sensors
std::optional<DiscriminatingExperiment> FindDiscriminatingExperiment(
    const Machine& machine, const Changes& one, const Changes& other);

}  // namespace mjdiag
