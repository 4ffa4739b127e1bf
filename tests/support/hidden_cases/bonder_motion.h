#pragma once
// What an owner of the wire bonder would record: moves of all axes to and fro over their
// range, one at a time and together, on top of slow tones, so that every joint goes slowly
// and fast in both directions (docs/own-machine.md).

#include "mjdiag/controllers/trajectory.h"
#include "mjdiag/plugin/machine/machine.h"
#include "support/hidden_cases/case_dice.h"

namespace mjdiag::test {

Trajectory BonderMotion(const Setup& setup, double duration, CaseDice dice);

}  // namespace mjdiag::test
