#pragma once
// What physics steps a record knows: those of the model, if a simulation made it; none, if a
// machine did; shorter ones, if it is of a simulation in finer steps.

#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

struct PhysicsSteps {
  /// Share of a step that is taken away to second order (Machine::WithoutSteps).
  double without = 0.0;
  /// In how many each is made.
  int finer = 1;

  bool AreGiven() const { return without == 0.0 && finer == 1; }
  /// As if there were none, or those of the model.
  PhysicsSteps Other() const { return {without > 0.0 ? 0.0 : 1.0, finer}; }
  Machine Of(const Machine& machine) const {
    const Machine made =
        finer > 1 ? machine.WithSubsteps(finer * machine.rates().substeps) : machine;
    return without > 0.0 ? made.WithoutSteps(without) : made;
  }
};

}  // namespace mjdiag
