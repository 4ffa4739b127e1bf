#include "mjdiag/studies/machine_study.h"

#include <gtest/gtest.h>

#include "mjdiag/studies/estimation_study.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

TEST(SmallestDeviation, IsWhereDetectionBegins) {
  for (const double sign : {1.0, -1.0}) {
    const auto smallest = SmallestDeviation(sign * 0.5, 1.01, [&](double deviation) {
      EXPECT_GT(deviation * sign, 0.0);
      return std::abs(deviation) >= 3e-4;
    });
    ASSERT_TRUE(smallest);
    EXPECT_GE(*smallest * sign, 3e-4);
    EXPECT_LE(*smallest * sign, 3e-4 * 1.01);
  }
}

TEST(SmallestDeviation, IsNoneWhereTheLargestIsNotSeen) {
  EXPECT_FALSE(SmallestDeviation(0.5, 1.01, [](double) { return false; }));
}

TEST(Cell, ShowsFourDigitsAndKeepsTheNumber) {
  const Cell cell(1.23456789e-7);
  EXPECT_EQ(cell.text, "1.235e-07");
  EXPECT_EQ(cell.number, 1.23456789e-7);
  EXPECT_TRUE(cell.is_number);
  EXPECT_FALSE(Cell("-").is_number);
}

// [AB383], Section 5.5 in small: 6 runs of each size.
TEST(EstimationStudy, FindsAllFaultsAtOnceWithinOnePerCent) {
  const Machine machine = test::Bonder();
  StudyOptions options;
  options.runs = 6;
  for (const StudyTable& table : EstimationStudy(machine, options)) {
    int judged = 0;
    for (const auto& row : table.rows) {
      if (!row[3].is_number) continue;
      EXPECT_LT(row[3].number, 1.0) << row[0].text;
      ++judged;
    }
    EXPECT_EQ(judged, 5);
  }
}

}  // namespace
}  // namespace mjdiag
