#pragma once
// The page of `mjdiag compare`: what the simulation gets wrong on a measured record.

#include <string>

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"

namespace mjdiag {

/// The answer in one sentence, for example "The simulation misses q by 400 times its
/// noise floor (1.1 µm rms)."
std::string ComparisonVerdict(const Comparison& comparison);

/// A row for every channel.
Table ChannelTable(const Comparison& comparison);
/// A row for every derived signal.
Table DerivedTable(const Comparison& comparison);
/// How far ahead it predicts, a column for every horizon.
Table PredictionTable(const Comparison& comparison);
/// A row for every joint.
Table DisturbanceTable(const Comparison& comparison);

/// The whole page.
Page ComparisonPage(const Comparison& comparison, const RunDescription& run);

}  // namespace mjdiag
