#pragma once
// What of a look goes into the history, and what pages get of it.

#include <string>
#include <vector>

#include "mjdiag/watch/judge/finding.h"
#include "mjdiag/watch/judge/history.h"

namespace mjdiag {

/// residual, integral, nis, missing; then every fault and its standard deviation.
std::vector<std::string> HistoryQuantities(const DiagnosisDesign& design);
/// In that order.
std::vector<HistoryValue> HistoryValuesOf(const Finding& look);

/// Rows of a level from a time on: {"width", "time": [...], "quantities": {name: {"min",
/// "mean", "max": [...]}}}. Empty if there is no such level.
std::string HistoryText(const History& history, std::size_t level, double from);

}  // namespace mjdiag
