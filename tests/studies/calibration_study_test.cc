#include <gtest/gtest.h>

#include <cstdlib>

#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/preset/preset_plan.h"

namespace mjdiag {
namespace {

/// The first number of "19 of 20".
int CountOf(const Cell& cell) { return std::atoi(cell.text.c_str()); }

// By a fault that is named in a healthy run once in 10^4, by one of a promised size that is
// missed once in 100, and by a region that leaves one machine in 20 out, the bounds are
// passed by chance with less than 10^-3 each.
TEST(CalibrationStudy, JudgesMachinesThatNobodyKnowsExactly) {
  const Machine stage(
      ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps", {"sensors.q.noise_power=1e-15"}));
  constexpr int kMachines = 5;
  LoadedPlan plan = ReadPreset("calibration", stage);
  plan.plan.SetRuns(kMachines);
  plan.plan.linear = true;
  StudyOptions options;
  std::size_t shown = 0;
  options.row = [&](const StudyTable& table) { shown = table.rows.size(); };
  const std::vector<StudyTable> tables = AnswerTo(plan, options);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[0].rows.size(), kMachines);
  EXPECT_EQ(shown, kMachines);
  // Each is another one.
  EXPECT_NE(tables[0].rows[0][1].text, tables[0].rows[1][1].text);
  ASSERT_EQ(tables[1].rows.size(), 3u);
  EXPECT_LE(CountOf(tables[1].rows[0][1]), 1) << tables[1].rows[0][1].text;
  EXPECT_GE(CountOf(tables[1].rows[1][1]), 8) << tables[1].rows[1][1].text;
  EXPECT_GE(CountOf(tables[1].rows[2][1]), 3) << tables[1].rows[2][1].text;
}

}  // namespace
}  // namespace mjdiag
