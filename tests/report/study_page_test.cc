#include "mjdiag/report/study_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/report/report.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

TEST(StudyPage, HasEveryTableWithItsNotes) {
  const std::vector<StudyTable> tables = {{"Smallest faults",
                                           {"fault", "size"},
                                           {{"zeta_x", 1.25}},
                                           {"On the linear plant."}},
                                          {"Delays", {"fault"}, {{"eta_y"}}, {}}};
  const std::string page =
      ReportHtml(StudyPage({"bonder", "table2", 40, 7}, tables, {"cmd", "", {}}));
  EXPECT_THAT(page, HasSubstr("<h1>Study table2 of bonder</h1>"));
  EXPECT_THAT(page, HasSubstr("<dd>40</dd>"));
  EXPECT_THAT(page, HasSubstr("<h2>Smallest faults</h2>"));
  EXPECT_THAT(page, HasSubstr("<p>On the linear plant.</p>"));
  EXPECT_THAT(page, HasSubstr("<h2>Delays</h2>"));
}

TEST(StudyPage, AlignsColumnsOfNumbersAndFillsShortRows) {
  // A number that was not found is a text; its column stays one of numbers.
  const std::vector<StudyTable> tables = {
      {"t", {"fault", "size"}, {{"a", "none"}, {"b", 1.25}, {"c"}}, {}}};
  const std::string page =
      ReportHtml(StudyPage({"bonder", "p", 2, 1}, tables, {"cmd", "", {}}));
  EXPECT_THAT(page, HasSubstr("<td>a</td><td class=\"number\">none</td>"));
  EXPECT_THAT(page, HasSubstr("<td>b</td><td class=\"number\">1.25</td>"));
  EXPECT_THAT(page, HasSubstr("<td>c</td><td class=\"number\"></td>"));
}

TEST(StudyPage, DrawsThePlotOfATableWithItsIntervals) {
  StudyTable table{"Reliability", {"probability"}, {{0.5}}, {}};
  table.plot = StudyPlot{"Share that holds",
                         "probability",
                         "share",
                         {{0.5, 0.4, 0.25, 0.75}},
                         {{0.0, 0.0}, {1.0, 1.0}}};
  const Page page = StudyPage({"bonder", "p", 2, 1}, {table}, {"cmd", "", {}});
  const std::string html = ReportHtml(page);
  EXPECT_THAT(html, HasSubstr("Share that holds"));
  EXPECT_THAT(html, HasSubstr("95 % interval"));
}

}  // namespace
}  // namespace mjdiag
