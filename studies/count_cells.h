#pragma once
// Counts of runs in a table: "190 of 200", 95 %, and the interval of the probability that
// they tell of (Clopper and Pearson).

#include <string>

#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Of the intervals in tables.
inline constexpr double kConfidence = 0.95;

/// "190 of 200"
std::string CountText(int count, int of);
/// 95; "-" of none.
Cell PerCent(int count, int of);
/// "91.04 to 97.58", of a probability [%]; "-" of none.
Cell IntervalCell(int count, int of);
/// A row of all three behind what they are of; none of none.
void AddCount(StudyTable& table, const std::string& what, int count, int of);

}  // namespace mjdiag
