#include "mjdiag/report/study_page.h"

#include <algorithm>

#include "mjdiag/report/page/page.h"

namespace mjdiag {
namespace {

bool HoldsNumbers(const StudyTable& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [column](const std::vector<Cell>& row) {
                       return column < row.size() && row[column].is_number;
                     });
}

Table ForPage(const StudyTable& study) {
  Table table;
  for (std::size_t i = 0; i < study.columns.size(); ++i) {
    table.columns.push_back({study.columns[i], HoldsNumbers(study, i)});
  }
  for (const std::vector<Cell>& cells : study.rows) {
    std::vector<std::string> row;
    row.reserve(study.columns.size());
    for (const Cell& cell : cells) row.push_back(cell.text);
    row.resize(study.columns.size());  // short rows end with empty cells
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

Page StudyPage(const StudyFacts& facts, const std::vector<StudyTable>& tables,
               const RunDescription& run) {
  Page page("Study " + facts.preset + " of " + facts.setup);
  page.AddFacts({{"Setup", facts.setup},
                 {"Preset", facts.preset},
                 {"Monte-Carlo runs", std::to_string(facts.runs)},
                 {"Seed of the first run", std::to_string(facts.seed)}});
  for (const StudyTable& table : tables) {
    page.AddHeading(table.title);
    page.AddTable(ForPage(table));
    for (const std::string& note : table.notes) page.AddParagraph(note);
  }
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
