#pragma once
// What is said of a draft: what could not be told, what was taken for granted, what is left
// over of the log and of the plant.

#include <string>
#include <vector>

#include "mjdiag/plugin/draft/log_columns.h"
#include "mjdiag/plugin/draft/name_match.h"
#include "mjdiag/plugin/draft/plant_places.h"
#include "mjdiag/plugin/draft/setup_draft.h"

namespace mjdiag {

/// A log beside the places of its plant, in the end.
struct MatchedLog {
  const LogColumns& log;
  const std::vector<Reading>& readings;
  const std::vector<Drive>& drives;
  const std::vector<ColumnChoice>& of_readings;
  const std::vector<ColumnChoice>& of_drives;
};

/// Adds to what a draft says, whose channels are complete.
void DescribeDraft(const MatchedLog& matched, SetupDraft& draft);

/// 'name'
std::string Quoted(const std::string& name);

}  // namespace mjdiag
