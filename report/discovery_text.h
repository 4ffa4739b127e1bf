#pragma once
// What a discovery says in words and tables, the same in a terminal and on a page.

#include <map>
#include <optional>
#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// The answer in a sentence or two: what was found, and what it gained on data that
/// nothing was fitted to.
std::string DiscoveryAnswer(const Discovery& discovery);

/// sqrt(mean (rms / floor)^2) of all channels with a floor above 0; none without them.
std::optional<double> TimesFloor(const std::map<std::string, double>& rms,
                                 const std::map<std::string, double>& floor);

/// A row for every parameter of every cause.
Table CauseTable(const Discovery& discovery);
/// What was tried, by how much it was better, and what came of it.
Table DecisionTable(const Discovery& discovery);
/// Every cause and who else could have been in its place.
Table CandidateTable(const Discovery& discovery);
/// All sets of causes that survive; no rows if there is one alone.
Table ExplanationTable(const Discovery& discovery);
/// The numbers of the plant that are others than the model says.
Table CalibrationTable(const Discovery& discovery);
/// Masses and their places together (CalibratedMoment), those that are off.
Table MomentTable(const Discovery& discovery);
/// Laws that resist a joint as one curve (FoundResistance).
Table ResistanceTable(const Discovery& discovery);
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
