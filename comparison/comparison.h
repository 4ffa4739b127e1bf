#pragma once
// What the simulation of a machine gets wrong on a measured record: the whole job from
// the record to the figures that tables, JSON and pages are made of.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/comparison/derived.h"
#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct Comparison {
  std::string setup;         ///< its name
  bool closed_loop = false;  ///< measured reference replayed, else measured input
  MismatchOptions options;   ///< how the figures were computed
  Record measured;           ///< the channels below
  Record simulated;          ///< the same channels, without sensor noise
  Record measured_derived;   ///< velocities, accelerations, forces
  Record simulated_derived;
  std::vector<ChannelMismatch> channels;  ///< sensors, then actuators
  std::vector<DerivedMismatch> derived;
  std::vector<std::string> not_measured;  ///< channels that the record lacks

  /// True if any channel exceeds its noise floor.
  bool exceeds_noise() const;
  /// The channel furthest above its noise floor, one that exceeds it if any does; null
  /// without channels.
  const ChannelMismatch* Worst() const;
};

/// Replays `measured` on the machine (see Replay), without sensor noise, and compares all
/// sensors and, in closed loop, actuators that the record has.
/// `options` gives disturbances, the seed of the noise floor and the progress callback;
/// its noise_scale is not used.
/// InputError if the record lacks what Replay needs or has no sensor of the setup.
Comparison Compare(const Machine& machine, const Record& measured,
                   const RunOptions& options);

}  // namespace mjdiag
