#include "mjdiag/studies/dataset/run_journals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

RunResult ResultOf(int run) {
  RunResult result;
  result.samples = 10 + run;
  result.series = {std::string(20, static_cast<char>('a' + run))};
  return result;
}

/// Runs 0 and 2 of four, made by ranks 3 and 1.
class Journals : public ::testing::Test {
 protected:
  Journals() {
    RunJournal(RunJournals::FileOf(folder_.path(), 3), "identity", 4)
        .Add(0, ResultOf(0));
    RunJournal(RunJournals::FileOf(folder_.path(), 1), "identity", 4)
        .Add(2, ResultOf(2));
  }

  bool IsThere(int rank) const {
    return std::filesystem::exists(RunJournals::FileOf(folder_.path(), rank));
  }

  test::TemporaryFolder folder_;
};

TEST_F(Journals, AreReadAsOne) {
  RunJournals journals(folder_.path(), "identity", 4);
  journals.Add(1, ResultOf(1));
  for (const int run : {0, 1, 2}) {
    EXPECT_TRUE(journals.Has(run, true)) << run;
    EXPECT_EQ(journals.Result(run).samples, 10 + run);
    EXPECT_EQ(journals.ReadSeries(run), ResultOf(run).series);
  }
  EXPECT_FALSE(journals.Has(3, false));
}

TEST_F(Journals, BecomeOneInTheEnd) {
  {
    RunJournals journals(folder_.path(), "identity", 4);
    journals.Add(1, ResultOf(1));
    journals.Settle();
    EXPECT_TRUE(journals.Has(2, false));
    EXPECT_FALSE(journals.Has(2, true));
  }
  EXPECT_FALSE(IsThere(1));
  EXPECT_FALSE(IsThere(3));
  const RunJournal one(RunJournals::FileOf(folder_.path(), 0), "identity", 4);
  EXPECT_THAT(one.Runs(), ::testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(one.Result(0).samples, 10);
}

TEST_F(Journals, OfAnotherStudyAreRefused) {
  EXPECT_THAT(
      test::MessageOf<InputError>([&] { RunJournals(folder_.path(), "Identity", 4); }),
      HasSubstr("another plan, setup or version"));
}

TEST_F(Journals, AreForgotten) {
  RunJournals::Remove(folder_.path());
  EXPECT_FALSE(IsThere(1));
  EXPECT_FALSE(IsThere(3));
}

TEST_F(Journals, MayBeCutOffAtTheirBeginning) {
  folder_.Write("runs.2.journal", "mjd");
  const RunJournals journals(folder_.path(), "identity", 4);
  EXPECT_TRUE(journals.Has(0, true));
}

}  // namespace
}  // namespace mjdiag
