#pragma once
// The page of `mjdiag study`: its tables with their notes.

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/report/page/page.h"
#include "mjdiag/report/page/run_description.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// What was studied.
struct StudyFacts {
  std::string setup;
  std::string preset;
  int runs = 0;
  std::uint64_t seed = 0;
  bool is_plan = false;  ///< one's own, by the name of its plan
};

/// The whole page. Columns that hold a number are aligned to the right.
Page StudyPage(const StudyFacts& facts, const std::vector<StudyTable>& tables,
               const RunDescription& run);

}  // namespace mjdiag
