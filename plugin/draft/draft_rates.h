#pragma once
// The clock of a drafted setup.

#include <string>
#include <vector>

#include "mjdiag/plugin/draft/setup_draft.h"

namespace mjdiag {

/// The control rate is that of the log, the nearest tick of whole steps of the plant where
/// one is within 2 %; else the plant gets a step that is part of the tick and not longer
/// than its own.
/// @param interval  usual time between rows [s]; 0: a tick is a step
void DraftRates(const mjModel& model, double interval, SetupDraft& draft);

}  // namespace mjdiag
