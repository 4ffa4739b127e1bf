#include "mjdiag/plugin/draft/log_columns.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

class LogColumnsOf : public ::testing::Test {
 protected:
  LogColumns Read(const std::string& header, double step) {
    std::string text = header + ",q\n";
    for (int k = 0; k < 20; ++k) text += std::to_string(step * k) + ",1\n";
    return ReadLogColumns(folder_.Write("log.csv", text));
  }
  test::TemporaryFolder folder_;
};

TEST_F(LogColumnsOf, ATimeWithoutAUnitIsInTheOneThatMakesARate) {
  EXPECT_EQ(Read("t", 0.002).time->unit, "s");
  EXPECT_EQ(Read("t", 0.1).time->unit, "s");
  EXPECT_TRUE(Read("t", 0.1).questions.empty());
  EXPECT_EQ(Read("t", 10.0).time->unit, "ms");
  EXPECT_EQ(Read("timestamp", 4000.0).time->unit, "us");
  EXPECT_DOUBLE_EQ(Read("t", 10.0).interval, 0.01);
  EXPECT_TRUE(Read("t", 10.0).questions.empty());
}

TEST_F(LogColumnsOf, ATimeThatMayBeInTwoUnitsIsAQuestion) {
  EXPECT_EQ(Read("t", 100.0).questions.size(), 1u);
  EXPECT_TRUE(Read("t [ms]", 100.0).questions.empty());
}

TEST_F(LogColumnsOf, ALogWithoutATimeIsAQuestion) {
  EXPECT_EQ(Read("x", 0.1).questions.size(), 1u);
  EXPECT_EQ(Read("t", -1.0).questions.size(), 1u);  // goes back
}

}  // namespace
}  // namespace mjdiag
