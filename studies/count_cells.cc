#include "mjdiag/studies/count_cells.h"

#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {

std::string CountText(int count, int of) {
  return std::to_string(count) + " of " + std::to_string(of);
}

Cell PerCent(int count, int of) {
  return of > 0 ? Cell(100.0 * count / of) : Cell("-");
}

Cell IntervalCell(int count, int of) {
  if (of == 0) return "-";
  const auto [low, high] = ProbabilityInterval(of, count, kConfidence);
  return Cell(100.0 * low).text + " to " + Cell(100.0 * high).text;
}

void AddCount(StudyTable& table, const std::string& what, int count, int of) {
  if (of == 0) return;
  table.rows.push_back(
      {what, CountText(count, of), PerCent(count, of), IntervalCell(count, of)});
}

}  // namespace mjdiag
