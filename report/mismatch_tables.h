#pragma once
// How far records are from their replays in a discovery, before and after, as tables, the
// same in a terminal and on a page.

#include <map>
#include <optional>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// "12.5 %"
std::string PercentText(double percent);

/// sqrt(mean (rms / floor)^2) of all channels with a floor above 0; none without them.
std::optional<double> TimesFloor(const std::map<std::string, double>& rms,
                                 const std::map<std::string, double>& floor);

/// Errors of the record after each cause that was added.
Table LadderTable(const Discovery& discovery);
/// The same of the validation record; no rows without one.
Table ValidationLadderTable(const Discovery& discovery);
/// rms of the mismatch of every channel before and after.
Table MismatchTable(const Discovery& discovery);
/// Free simulation of every record before and after; no rows of one record alone.
Table RecordTable(const Discovery& discovery);
/// The smallest fault that is seen, with either plant.
Table FaultLimitTable(const Discovery& discovery);

}  // namespace mjdiag
