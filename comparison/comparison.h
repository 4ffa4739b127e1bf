#pragma once
// What the simulation of a machine gets wrong on a measured record: the whole job from
// the record to the figures that tables, JSON and pages are made of.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjdiag/comparison/derived.h"
#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/comparison/missing_force.h"
#include "mjdiag/comparison/prediction.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

// Driven by its inputs alone a machine may fall that did not when it was measured: a
// controller held it that nobody wrote down. An open-loop simulation says nothing of the
// model then. Where it diverges, or a sensor goes further from its measurement than that
// spans, and the machine has left its rest (motion_path.h), the comparison is one beside an
// observer that follows the measured motion: how far ahead the model predicts
// (prediction.h), and the force that it lacks at every joint (missing_force.h). Simulated
// is then what it predicts from one tick to the next.

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
  bool falls = false;  ///< as above: what follows is there, derived is not
  Prediction prediction;
  std::vector<MissingForce> missing_force;
  double bandwidth = 0.0;  ///< of the observer [Hz]

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

/// Whether a machine falls that is driven with the inputs of the record alone.
/// InputError as above.
bool Falls(const Machine& machine, const Record& measured);

/// The comparison of a machine that falls.
/// Of all that has been put into it, `changes` alone is unknown to the observer, which is
/// that of `machine`: comparisons with and without changes stand beside one another.
/// Without prediction and missing forces.
/// @param bandwidth  of the observer [Hz]
Comparison CompareFollowed(const Machine& machine, const Changes& changes,
                           const Record& measured, double bandwidth);

}  // namespace mjdiag
