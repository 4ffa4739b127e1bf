#pragma once
// What a discovery says in words and tables, the same in a terminal and on a page.

#include <string>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// The answer in a sentence or two: what was found, and what it gained on data that
/// nothing was fitted to.
std::string DiscoveryAnswer(const Discovery& discovery);

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

}  // namespace mjdiag
