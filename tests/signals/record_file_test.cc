#include "mjdiag/signals/record_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return false;
  for (Index k = 0; k < a.size(); ++k) {
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) {
      return false;
    }
  }
  return true;
}

/// Numbers of every size, with the ones at the edges of the format.
Record DemandingRecord(double sample_time, double start_time) {
  constexpr Index kSamples = 500;
  std::mt19937_64 random(7);
  Record record(sample_time, start_time);
  const char* const long_name =
      "a_name_of_more_than_the_sixty_three_letters_that_matlab_allows_in_a_name";
  for (const char* name :
       {"x", "joint.X", "joint_X", "2nd, \"odd\" [name]", long_name}) {
    Eigen::VectorXd samples(kSamples);
    for (double& sample : samples) {
      do {
        sample = std::bit_cast<double>(random());
      } while (!std::isfinite(sample));
    }
    samples[0] = -0.0;
    samples[1] = std::numeric_limits<double>::denorm_min();
    samples[2] = std::numeric_limits<double>::max();
    samples[3] = 0.1;
    record.Add({name, "N m/rad", samples});
  }
  return record;
}

class RoundTrip : public testing::TestWithParam<RecordFormat> {};

TEST_P(RoundTrip, IsBitwise) {
  const test::TemporaryFolder folder;
  for (const double sample_time : {1.0 / 8000.0, 1.0 / 3000.0, 0.001, 0.1}) {
    const Record record = DemandingRecord(sample_time, 0.25);
    WriteRecord(folder / "record", record, GetParam());
    const Record back = ReadRecord(folder / "record");
    EXPECT_EQ(back.sample_time(), record.sample_time());
    EXPECT_EQ(back.start_time(), record.start_time());
    ASSERT_EQ(back.channels().size(), record.channels().size());
    for (std::size_t i = 0; i < record.channels().size(); ++i) {
      EXPECT_EQ(back.channels()[i].name, record.channels()[i].name);
      EXPECT_EQ(back.channels()[i].unit, record.channels()[i].unit);
      EXPECT_TRUE(SameBits(back.channels()[i].samples, record.channels()[i].samples))
          << record.channels()[i].name;
    }
  }
  EXPECT_EQ(folder.size(), 1) << "a temporary file was left behind";
}

TEST_P(RoundTrip, RefusesToWriteWhatCouldNotBeReadBack) {
  const test::TemporaryFolder folder;
  const auto write = [&](const Channel& channel) {
    Record record(1.0);
    record.Add(channel);
    WriteRecord(folder / "record", record, GetParam());
  };
  EXPECT_THROW(write({"x", "m", Eigen::Vector2d(1.0, NAN)}), InputError);
  EXPECT_THROW(write({"x", "m", Eigen::VectorXd::Zero(1)}), InputError);
  EXPECT_THROW(write({"x", "um", Eigen::Vector2d::Zero()}), InputError);
  EXPECT_THROW(write({"x", "furlong", Eigen::Vector2d::Zero()}), InputError);
  EXPECT_THROW(write({"time", "s", Eigen::Vector2d::Zero()}), InputError);
  EXPECT_EQ(folder.size(), 0);
  EXPECT_NO_THROW(write({"x", "m", Eigen::Vector2d::Zero()}));
}

TEST_P(RoundTrip, NamesTheFolderThatIsMissing) {
  Record record(1.0);
  record.Add({"x", "m", Eigen::Vector2d::Zero()});
  EXPECT_THAT([&] { WriteRecord("/no/such/folder/record", record, GetParam()); },
              ThrowsMessage<InputError>(HasSubstr("no folder /no/such/folder")));
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(RecordFormat::kCsv, RecordFormat::kMat5,
                                         RecordFormat::kMat73));

class CsvRecord : public testing::Test {
 protected:
  Record Read(const std::string& text,
              const std::optional<ColumnMap>& map = std::nullopt) const {
    WriteTextFile(folder_ / "r.csv", text);
    return ReadRecord(folder_ / "r.csv", map);
  }
  /// The message without the folder; one line.
  std::string Error(const std::string& text,
                    const std::optional<ColumnMap>& map = std::nullopt) const {
    try {
      Read(text, map);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, Not(HasSubstr("\n")));
      return message.substr((folder_ / "").string().size());
    }
    return "no error";
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(CsvRecord, TakesAnIndexInBracketsForNoUnit) {
  const Record record = Read(
      "time,q[0],q[1] [deg],q(2),q [3],ratio [1],x [mm]\n0,1,180,3,4,5,6\n1,1,180,3,"
      "4,5,6\n");
  std::vector<std::pair<std::string, std::string>> channels;
  for (const Channel& channel : record.channels()) {
    channels.emplace_back(channel.name, channel.unit);
  }
  EXPECT_THAT(channels, testing::ElementsAre(
                            testing::Pair("q[0]", "1"), testing::Pair("q[1]", "rad"),
                            testing::Pair("q(2)", "1"), testing::Pair("q [3]", "1"),
                            testing::Pair("ratio", "1"), testing::Pair("x", "m")));
  ColumnMap map;
  map.columns = {{"first", "q[0]", "rad"}};
  EXPECT_EQ(Read("time,q[0]\n0,1\n1,2\n", map).At("first").unit, "rad");
}

TEST_F(CsvRecord, ReadsTheDialectsOfOtherPrograms) {
  const std::pair<const char*, const char*> dialects[] = {
      {"comma", "time [s],x [m]\n0,1\n0.5,-2e0\n"},
      {"semicolon", "time [s];x [m]\n0;1\n0.5;-2\n"},
      {"tab", "time [s]\tx [m]\n0\t1\n0.5\t-2\n"},
      {"CRLF", "time [s],x [m]\r\n0,1\r\n0.5,-2\r\n"},
      {"no last newline", "time [s],x [m]\n0,1\n0.5,-2"},
      {"quoted", "\"time [s]\",\"x [m]\"\n\"0\",1\n0.5,\"-2\"\n"},
      {"parentheses", "time (s),x (m)\n0,1\n0.5,-2\n"},
      {"blanks", " time [s] , x  [ m ]\n 0 , +1\n\n0.5, -2 \n\n"},
      {"comments", "# one\n\n# two, three\ntime,x [m]\n0,1\n0.5,-2\n"},
      {"byte-order mark", "\xEF\xBB\xBFtime,x [m]\n0,1\n0.5,-2\n"},
      {"other units", "time [ms],x [mm]\n0,1e3\n500,-2000\n"},
  };
  for (const auto& [name, text] : dialects) {
    SCOPED_TRACE(name);
    const Record record = Read(text);
    EXPECT_EQ(record.sample_time(), 0.5);
    ASSERT_EQ(record.channels().size(), 1U);
    EXPECT_EQ(record.channels()[0].name, "x");
    EXPECT_EQ(record.channels()[0].unit, "m");
    EXPECT_TRUE(record.channels()[0].samples.isApprox(Eigen::Vector2d(1.0, -2.0)));
  }
}

TEST_F(CsvRecord, IsReadThroughAColumnMap) {
  ColumnMap map;
  map.time = {"", "t", "ms", false};
  map.columns = {{"force", "F (left)", "kN", false},
                 {"none", "absent", "m", true},
                 {"x", "x", "", false}};
  const Record record = Read("note,t,F (left),x [um]\nstart,10,1,4\nend,20,2,5\n", map);
  EXPECT_EQ(record.sample_time(), 0.01);
  EXPECT_EQ(record.start_time(), 0.01);
  ASSERT_EQ(record.channels().size(), 2U);
  EXPECT_EQ(record.At("force").samples, Eigen::Vector2d(1000.0, 2000.0));
  EXPECT_EQ(record.At("force").unit, "N");
  EXPECT_TRUE(record.At("x").samples.isApprox(Eigen::Vector2d(4e-6, 5e-6), 1e-15));
}

TEST_F(CsvRecord, SaysWhereItIsWrong) {
  ColumnMap map;
  map.columns = {{"y", "y", "m", false}};
  EXPECT_EQ(Error("time,x [m]\n0,1\n1,2\n", map),
            "r.csv: no column \"y\"; expected one of time, x");
  EXPECT_EQ(Error("t,x\n0,1\n1,2\n"),
            "r.csv: no column \"time\"; expected one of t, x");
  EXPECT_EQ(Error("time,x\n0,1\n1,nan\n"),
            R"(r.csv: line 3, column "x": "nan"; expected a finite number)");
  EXPECT_EQ(Error("#\n\ntime,x\n0,inf\n1,2\n"),
            R"(r.csv: line 4, column "x": "inf"; expected a finite number)");
  EXPECT_EQ(Error("time,x\n0,1\n1,high\n"),
            R"(r.csv: line 3, column "x": "high"; expected a finite number)");
  EXPECT_EQ(Error("time,x\n0,1\n1,\n"),
            R"(r.csv: line 3, column "x": ""; expected a finite number)");
  EXPECT_EQ(Error("time,x\n0,1.5mm\n1,\n"),
            R"(r.csv: line 2, column "x": "1.5mm"; expected a finite number)");
  EXPECT_EQ(Error("time,x\n0,1\n1\n"),
            "r.csv: line 3: 1 cells; expected 2 as the header row has");
  EXPECT_EQ(Error("time,x\n0,1,2\n1,2\n"),
            "r.csv: line 2: 3 cells; expected 2 as the header row has");
  EXPECT_THAT(Error("time,x [furlong]\n0,1\n1,2\n"),
              testing::StartsWith(R"(r.csv: column "x": unknown unit "furlong"; )"));
  EXPECT_EQ(Error("time [m],x\n0,1\n1,2\n"),
            R"(r.csv: column "time": time in "m"; expected a unit of time)");
  EXPECT_EQ(Error("0,1\n1,2\n"),
            "r.csv: line 1: a number in the header row; expected names of columns");
  EXPECT_EQ(Error("time,x,x\n0,1,1\n1,2,2\n"),
            R"(r.csv: column "x": a second channel "x"; expected every name once)");
  EXPECT_EQ(Error("time\n0\n1\n"),
            "r.csv: no channel besides the time; expected at least one");
  EXPECT_THAT(Error(std::string("\0\1\2", 3)), HasSubstr("unknown format"));
  // Bytes that would go to the terminal as names of columns.
  EXPECT_THAT(Error("\xb5,\x1b[2J\n1,2\n2,3\n"), HasSubstr("unknown format"));
}

TEST_F(CsvRecord, RefusesFilesWithNothingInThem) {
  EXPECT_THAT(Error(""), HasSubstr("is empty"));
  EXPECT_THAT(Error(" \n\n"), HasSubstr("is empty"));
  EXPECT_THAT(Error("# only this\n"), HasSubstr("comments only"));
  EXPECT_THAT(Error("time,x\n"), HasSubstr("header row only"));
  EXPECT_THAT(Error("time,x\n0,1\n"), HasSubstr("1 samples; expected at least two"));
}

TEST_F(CsvRecord, SaysWhereTimeIsNotUniform) {
  EXPECT_EQ(Error("time,x\n0,1\n0.5,1\n0.5,1\n"),
            "r.csv: line 4, column \"time\": time does not increase (0.5 s after 0.5 "
            "s); expected a later time in every sample");
  EXPECT_EQ(Error("time,x\n0,1\n1,1\n3,1\n4,1\n5,1\n"),
            "r.csv: line 4, column \"time\": time is not uniform (interval 2 s, "
            "elsewhere 1 s); expected every time within 1 % of a sample of the uniform "
            "grid");
  EXPECT_THAT(Error("time,x\n0,1\n1,1\n2.02,1\n3,1\n"), HasSubstr("line 4"));
  EXPECT_EQ(Read("time,x\n0,1\n1,1\n2.009,1\n3,1\n").sample_time(), 1.0);
}

TEST_F(CsvRecord, RefusesTimeThatDriftsSlowly) {
  std::string text = "time,x\n";
  for (int k = 0; k < 200; ++k) {
    text += std::to_string(k * (1.0 + 1e-4 * k)) + ",0\n";
  }
  EXPECT_THAT(Error(text), HasSubstr("time is not uniform"));
}

TEST(ReadRecord, NamesTheFileThatIsNotThere) {
  EXPECT_THAT(
      [] { ReadRecord("no_such_file.csv"); },
      ThrowsMessage<InputError>(HasSubstr("no_such_file.csv: cannot be opened")));
}

}  // namespace
}  // namespace mjdiag
