#pragma once
// What the simulation of a machine gets wrong on a measured record: the whole job from
// the record to the figures that tables, JSON and pages are made of.

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/comparison/derived.h"
#include "mjdiag/discovery/comparison/disturbance_estimate.h"
#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/discovery/comparison/prediction.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

// Of every machine, whether it stands, swings, is held or falls, the filter that follows the
// measured motion (plugin/replay/force_filter.h) says how far ahead the model predicts
// (prediction.h), the force that it lacks at every joint (missing_force.h), and how probable
// the record is beside it: -2 ln L, which orders models of one record.
//
// A free simulation stands beside that where the machine does not run away in it. Driven by
// its inputs alone one may fall that did not when it was measured: a controller held it that
// nobody wrote down. Where it diverges, or in open loop goes further from its measurement than
// that spans, it says nothing of the model. Simulated is then what the filter predicts from
// one tick to the next.

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
  bool falls = false;  ///< as above: no free simulation, and nothing derived
  /// From here on empty where the record lacks sensors or commands.
  Prediction prediction;
  std::vector<DisturbanceEstimate> missing_force;
  std::optional<double> deviance;  ///< -2 ln L

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

/// The free simulation alone. NumericalError if it diverges.
/// @param like  has the noise floors, of all but the same machine; null: from draws of the noise
Comparison CompareFree(const Machine& machine, const Record& measured,
                       const RunOptions& options, const Comparison* like = nullptr);

/// Whether a machine falls that is driven with the inputs of the record alone, where that has
/// all that the filter needs. InputError as above.
bool DivergesOpenLoop(const Machine& machine, const Record& measured);

/// What is predicted over one tick, of a machine and of the same with changes, behind the
/// noise that is most likely beside the first: the two stand beside one another. Without
/// prediction and missing forces.
struct FollowedPair {
  Comparison before;
  Comparison after;
};
/// @param near  a noise near to which it is; null: from nothing
FollowedPair CompareFollowed(const Machine& machine, const Machine& changed,
                             const Record& measured, const FilterNoise* near = nullptr);

}  // namespace mjdiag
