#include "mjdiag/studies/dataset/run_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
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
  result.detected = true;
  result.nis = 0.1 * run;
  result.faults = {{1.5, 0.25, true}, {1.0, 0.5, false}};
  result.features = {1.0, -2.0, 3.0 + run};
  result.series = {std::string("\0ab", 3), std::string(20, static_cast<char>(run))};
  return result;
}

void ExpectSame(const RunJournal& journal, int run) {
  const RunResult wanted = ResultOf(run);
  const RunResult& found = journal.Result(run);
  EXPECT_EQ(found.samples, wanted.samples);
  EXPECT_EQ(found.nis, wanted.nis);
  EXPECT_EQ(found.features, wanted.features);
  ASSERT_EQ(found.faults.size(), 2u);
  EXPECT_EQ(found.faults[0].sd, 0.25);
  EXPECT_TRUE(found.faults[0].named);
  EXPECT_EQ(journal.ReadSeries(run), wanted.series);
}

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Journal : public ::testing::Test {
 protected:
  Journal() {
    RunJournal journal(file_, "identity", 4);
    journal.Add(2, ResultOf(2));
    before_ = std::filesystem::file_size(file_);
    journal.Add(0, ResultOf(0));
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "runs.journal";
  std::uintmax_t before_ = 0;
};

TEST_F(Journal, HasAllThatWasAdded) {
  const RunJournal journal(file_, "identity", 4);
  EXPECT_TRUE(journal.Has(0, true));
  EXPECT_FALSE(journal.Has(1, false));
  EXPECT_TRUE(journal.Has(2, true));
  ExpectSame(journal, 0);
  ExpectSame(journal, 2);
}

TEST_F(Journal, LosesOnlyTheEntryThatWasBeingWritten) {
  const std::string whole = Bytes(file_);
  for (std::uintmax_t size = before_; size < whole.size(); ++size) {
    folder_.Write("runs.journal", whole.substr(0, size));
    {
      RunJournal journal(file_, "identity", 4);
      EXPECT_TRUE(journal.Has(2, true)) << size;
      EXPECT_FALSE(journal.Has(0, false)) << size;
      journal.Add(0, ResultOf(0));
    }
    EXPECT_EQ(Bytes(file_), whole) << size;
  }
}

TEST_F(Journal, MayHaveBeenKilledInItsBeginning) {
  const std::string whole = Bytes(file_);
  for (std::size_t size = 0; size < 20; ++size) {
    folder_.Write("runs.journal", whole.substr(0, size));
    RunJournal journal(file_, "identity", 4);
    EXPECT_FALSE(journal.Has(2, false));
    journal.Add(2, ResultOf(2));
    EXPECT_EQ(Bytes(file_), whole.substr(0, before_));
  }
}

TEST_F(Journal, DoesNotBelieveABrokenEntry) {
  std::string whole = Bytes(file_);
  for (std::size_t at = before_; at < whole.size(); at += 7) {
    std::string broken = whole;
    broken[at] = static_cast<char>(broken[at] ^ 1);
    folder_.Write("runs.journal", broken);
    const RunJournal journal(file_, "identity", 4);
    EXPECT_FALSE(journal.Has(0, false)) << at;
    EXPECT_TRUE(journal.Has(2, true)) << at;
  }
}

TEST_F(Journal, OfAnotherStudyIsRefusedAndLeftUnchanged) {
  const std::string whole = Bytes(file_);
  const std::string message =
      test::MessageOf<InputError>([&] { RunJournal(file_, "Identity", 4); });
  EXPECT_THAT(message, HasSubstr("another plan, setup or version"));
  EXPECT_EQ(Bytes(file_), whole);
}

TEST_F(Journal, IsOfOneProcessAtATime) {
  const RunJournal journal(file_, "identity", 4);
  EXPECT_THAT(test::MessageOf<InputError>([&] { RunJournal(file_, "identity", 4); }),
              HasSubstr("another process is at work"));
  EXPECT_THAT(test::MessageOf<InputError>([&] { RunJournal::Remove(file_); }),
              HasSubstr("another process is at work"));
}

TEST_F(Journal, IsForgottenWhereNobodyIsAtWork) {
  RunJournal::Remove(file_);
  EXPECT_FALSE(std::filesystem::exists(file_));
  RunJournal::Remove(file_);  // there is none
}

TEST_F(Journal, GivesItsSeriesAway) {
  RunJournal journal(file_, "identity", 4);
  ASSERT_TRUE(journal.HoldsSeries());
  journal.Settle();
  EXPECT_FALSE(journal.HoldsSeries());
  EXPECT_TRUE(journal.Has(0, false));
  EXPECT_FALSE(journal.Has(0, true));
  EXPECT_EQ(journal.Result(2).features, ResultOf(2).features);
  journal.Add(1, ResultOf(1));
  ExpectSame(journal, 1);
}

}  // namespace
}  // namespace mjdiag
