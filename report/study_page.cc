#include "mjdiag/report/study_page.h"

#include <algorithm>
#include <limits>

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

/// Intervals are one broken line.
XyPlot ForPage(const StudyPlot& study) {
  constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
  const auto points = static_cast<Eigen::Index>(study.points.size());
  const auto curve = static_cast<Eigen::Index>(study.curve.size());
  XyPoints measured{"found", CurveRole::kMeasured, Eigen::VectorXd(points),
                    Eigen::VectorXd(points)};
  XyCurve intervals{"95 % interval", CurveRole::kNoise, Eigen::VectorXd(3 * points),
                    Eigen::VectorXd(3 * points)};
  XyCurve expected{"expected", CurveRole::kSimulated, Eigen::VectorXd(curve),
                   Eigen::VectorXd(curve)};
  Eigen::Index i = 0;
  for (const StudyPlot::Point& point : study.points) {
    measured.x[i] = point.x;
    measured.y[i] = point.y;
    intervals.x.segment(3 * i, 3).setConstant(point.x);
    intervals.y.segment(3 * i, 3) << point.low, point.high, kBreak;
    ++i;
  }
  i = 0;
  for (const auto& [x, y] : study.curve) {
    expected.x[i] = x;
    expected.y[i++] = y;
  }
  XyPlot plot{study.caption, study.x_quantity, "1", study.y_quantity,
              "1",           {measured},       {}};
  const bool has_intervals = std::ranges::any_of(
      study.points,
      [](const StudyPlot::Point& point) { return point.low < point.high; });
  if (!study.curve.empty()) plot.curves.push_back(expected);
  if (has_intervals) plot.curves.push_back(intervals);
  return plot;
}

}  // namespace

Page StudyPage(const StudyFacts& facts, const std::vector<StudyTable>& tables,
               const RunDescription& run) {
  Page page("Study " + facts.preset + " of " + facts.setup);
  page.AddFacts(
      {{"Setup", facts.setup},
       {facts.is_plan ? "Plan" : "Preset", facts.preset},
       {facts.is_plan ? "Runs" : "Monte-Carlo runs", std::to_string(facts.runs)},
       {facts.is_plan ? "Seed" : "Seed of the first run", std::to_string(facts.seed)}});
  for (const StudyTable& table : tables) {
    page.AddHeading(table.title);
    if (!table.columns.empty()) page.AddTable(ForPage(table));
    if (table.plot) page.AddPlot(ForPage(*table.plot));
    for (const std::string& note : table.notes) page.AddParagraph(note);
  }
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
