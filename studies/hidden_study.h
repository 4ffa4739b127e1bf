#pragma once
// How often discovery is right: effects are hidden in simulated measurements
// (hidden_effect.h) and looked for. Every run is one seed; its draw, its noise and its
// answer follow from it.

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/studies/hidden_effect.h"

namespace mjdiag {

/// What came of one run.
struct HiddenOutcome {
  HiddenCase hidden;  ///< without its records
  Discovery answer;
  int named = 0;       ///< of the truth, effect (or an indistinguishable one) and site
  bool claim = false;  ///< that anything is there, with or without a name
  bool right = false;  ///< all named, and nothing else
  /// Of the truth, named, or given as what the record does not tell from what is named.
  int considered = 0;
  /// Not right, but all considered, and nothing else named.
  bool undecided = false;
  int parameters = 0;  ///< of those that were named
  int covered = 0;     ///< of them inside their 95 % interval
  /// Mismatch of the extended plant on the unseen motion over its noise floor, the
  /// worst channel.
  double unseen_ratio = 0.0;
};

/// @param causes  how many effects are hidden: 0, 1 or 2
/// @param types   of the effects, as many as causes (see DrawEffect)
HiddenOutcome RunHidden(const Machine& machine, const std::vector<std::string>& types,
                        std::uint64_t seed);

/// The types of run number `run`: one after the other of the registry.
std::vector<std::string> TypesOfRun(int run, int causes);

/// True if the answer names that cause, or one that no measurement tells from it.
bool Names(const FoundCause& found, const Cause& truth);

}  // namespace mjdiag
