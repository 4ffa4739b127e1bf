#include "mjdiag/signals/measured_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mjdiag/signals/bridging.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/record_file.h"
#include "mjdiag/signals/text_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using test::MessageOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Index kSamples = 1000;
constexpr double kTick = 0.001;  // s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double MotionAt(double t) { return std::sin(9.0 * t) + 0.3 * std::cos(31.0 * t); }

/// A reading q and an input u at every tick.
MeasuredColumns Whole() {
  MeasuredColumns columns;
  columns.times = VectorXd::NullaryExpr(
      kSamples, [](Index k) { return kTick * static_cast<double>(k); });
  columns.channels = {{"q", "rad", columns.times.unaryExpr(&MotionAt)},
                      {"u", "N", VectorXd::LinSpaced(kSamples, 0.0, 1.0)}};
  columns.place = [](Index k) { return "row " + std::to_string(k); };
  return columns;
}

MeasuredFile Read(const MeasuredColumns& columns) {
  Resampling resampling{kTick, {{"u", Course::kHeld}}, {}};
  resampling.readings["q"] = {};
  return RecordOfColumns(columns, resampling);
}

MeasuredColumns WithoutRows(MeasuredColumns columns, Index first, Index count) {
  const auto cut = [&](VectorXd& x) {
    VectorXd fewer(x.size() - count);
    fewer << x.head(first), x.tail(x.size() - first - count);
    x = fewer;
  };
  cut(columns.times);
  for (Channel& channel : columns.channels) cut(channel.samples);
  return columns;
}

/// Samples that were measured are what was measured.
void ExpectTrue(const Record& record, double accuracy) {
  const Channel& q = record.At("q");
  const VectorXd expected = record.Time().unaryExpr(&MotionAt);
  EXPECT_TRUE(q.samples.allFinite());
  EXPECT_LT(Kept(q.samples - expected, q.measured).cwiseAbs().maxCoeff(), accuracy);
}

TEST(MeasuredColumns, ThatLackNothingAreTakenAsTheyAre) {
  const MeasuredFile file = Read(Whole());
  EXPECT_THAT(file.notes, IsEmpty());
  EXPECT_EQ(file.record.At("q").samples, Whole().channels[0].samples);
  EXPECT_EQ(file.record.At("q").measured.size(), 0);
}

TEST(MeasuredColumns, KeepTheGapsOfMissingRows) {
  const MeasuredFile file = Read(WithoutRows(WithoutRows(Whole(), 700, 1), 300, 8));
  ASSERT_EQ(file.record.samples(), kSamples);
  const SampleMask& measured = file.record.At("q").measured;
  EXPECT_EQ(measured.size() - measured.count(), 8);  // one that is missing is bridged
  EXPECT_FALSE(measured[300] || measured[307]);
  EXPECT_TRUE(measured[299] && measured[308] && measured[700]);
  ExpectTrue(file.record, 1e-6);
  EXPECT_NEAR(file.record.At("u").samples[700], 700.0 / (kSamples - 1), 1e-9);
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("9 samples are missing"),
                                      HasSubstr("1 gap of 9.00 ms at 299 ms: the model "
                                                "runs on there")));
}

TEST(MeasuredColumns, MayHaveNoValuesHereAndThere) {
  MeasuredColumns columns = Whole();
  columns.channels[0].samples.segment(100, 5).setConstant(kNan);
  columns.channels[0].samples[500] = kNan;
  columns.channels[1].samples.segment(200, 3).setConstant(kNan);
  const MeasuredFile file = Read(columns);
  const Channel& q = file.record.At("q");
  EXPECT_EQ(q.measured.size() - q.measured.count(), 6);
  ExpectTrue(file.record, 1e-12);
  EXPECT_NEAR(q.samples[500], MotionAt(0.5), 1e-6);
  const VectorXd& u = file.record.At("u").samples;
  EXPECT_NEAR(u[201], 201.0 / (kSamples - 1), 1e-12);
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("'q' has no value at 6 samples: the "
                                                "model runs on there"),
                                      HasSubstr("'u' has no value at 3 samples")));
}

TEST(MeasuredColumns, AreCutWhereChannelsHaveNotBegun) {
  MeasuredColumns columns = Whole();
  columns.channels[0].samples.head(4).setConstant(kNan);
  columns.channels[1].samples.tail(7).setConstant(kNan);
  const MeasuredFile file = Read(columns);
  EXPECT_EQ(file.record.samples(), kSamples - 11);
  EXPECT_DOUBLE_EQ(file.record.start_time(), 0.004);
  EXPECT_EQ(file.record.At("q").measured.size(), 0);
  EXPECT_THAT(file.notes.back(), HasSubstr("the first 4 and the last 7 samples"));
}

// The rest says nothing of that sensor, but of the others.
TEST(MeasuredColumns, OfASensorThatDiesGoOn) {
  MeasuredColumns columns = Whole();
  columns.channels[0].samples.tail(300).setConstant(kNan);
  const MeasuredFile file = Read(columns);
  EXPECT_EQ(file.record.samples(), kSamples);
  EXPECT_EQ(file.record.At("q").measured.count(), 700);
}

TEST(MeasuredColumns, OfASlowSensorHoldWhatWasMeasured) {
  for (const bool held : {true, false}) {
    MeasuredColumns columns = Whole();
    VectorXd& q = columns.channels[0].samples;
    for (Index k = 0; k < kSamples; ++k) {
      if (k % 4 != 0) q[k] = held ? q[k - k % 4] : kNan;
    }
    const MeasuredFile file = Read(columns);
    EXPECT_EQ(file.record.At("q").measured.count(), kSamples / 4) << held;
    ExpectTrue(file.record, 1e-12);
    // And what lies between is near.
    EXPECT_LT((file.record.At("q").samples - file.record.Time().unaryExpr(&MotionAt))
                  .head(990)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-3);
  }
}

TEST(MeasuredColumns, AtAnotherRateGoOnTheWantedGrid) {
  MeasuredColumns slow = Whole();
  slow.times *= 5.0;
  slow.channels[0].samples = slow.times.unaryExpr(&MotionAt);
  const MeasuredFile file = Read(slow);
  EXPECT_EQ(file.record.sample_time(), kTick);
  EXPECT_EQ(file.record.samples(), 4996);
  EXPECT_EQ(file.record.At("q").measured.count(), kSamples);
  ExpectTrue(file.record, 1e-9);
  EXPECT_THAT(file.notes.front(), HasSubstr("samples are 5.00 ms apart"));
}

TEST(MeasuredColumns, MayHaveRowsThatAreOutOfTime) {
  MeasuredColumns columns = Whole();
  columns.times[400] = columns.times[399];
  columns.times[600] = kNan;
  const MeasuredFile file = Read(columns);
  EXPECT_EQ(file.record.samples(), kSamples);
  ExpectTrue(file.record, 1e-6);
  EXPECT_THAT(file.notes.front(), HasSubstr("2 rows are left out"));
}

TEST(MeasuredColumns, AreRefusedWithWhatToDo) {
  MeasuredColumns again = Whole();
  again.times.tail(500) = again.times.head(500).eval();
  EXPECT_THAT(
      MessageOf<InputError>([&] { Read(again); }),
      HasSubstr("row 500: time does not increase here, nor in 500 of 1000 rows; "
                "expected a later time in every row: sort the rows, or split"));
  MeasuredColumns nothing = Whole();
  nothing.channels[0].samples.setConstant(kNan);
  EXPECT_THAT(MessageOf<InputError>([&] { Read(nothing); }),
              HasSubstr("'q' has no values; expected two at least"));
  MeasuredColumns late = Whole();
  late.times.tail(10).array() += 60.0;
  EXPECT_THAT(
      MessageOf<InputError>([&] { Read(late); }),
      HasSubstr("is missing for 98 % of its time; expected the parts in which"));
  MeasuredColumns milliseconds = Whole();
  milliseconds.times *= 1000.0;
  EXPECT_THAT(MessageOf<InputError>([&] { Read(milliseconds); }),
              HasSubstr("the unit of its times under [record.time]"));
}

TEST(MeasuredFile, OfCsvMayHaveEmptyCellsAndAnUnfinishedRow) {
  const test::TemporaryFolder folder;
  WriteTextFile(folder / "r.csv", "time,q,u\n0,1,0\n1,,0\n2,nan,0\n3,4,0\n4,5,0\n5,6");
  Resampling resampling{1.0, {}, {}};
  resampling.readings["q"] = {};
  const MeasuredFile file =
      ReadMeasuredFile(folder / "r.csv", std::nullopt, resampling);
  EXPECT_EQ(file.record.samples(), 5);
  EXPECT_EQ(file.record.At("q").Measured(), (VectorXd(3) << 1, 4, 5).finished());
  EXPECT_EQ(file.record.At("u").measured.size(), 0);
  WriteTextFile(folder / "text.csv", "time,q\n0,1\n1,broken\n2,3\n");
  EXPECT_THAT(MessageOf<InputError>([&] {
                ReadMeasuredFile(folder / "text.csv", std::nullopt, resampling);
              }),
              HasSubstr("line 3, column \"q\": \"broken\""));
}

TEST(InGaps, AreSamplesFarFromOthers) {
  SampleMask measured = SampleMask::Constant(40, false);
  for (const Index k : {1, 5, 9, 13, 29, 33}) measured[k] = true;
  const SampleMask gaps = InGaps(measured);
  for (Index k = 0; k < 40; ++k) {
    EXPECT_EQ(gaps[k], k < 1 || k > 33 || (k > 13 && k < 29)) << k;
  }
}

}  // namespace
}  // namespace mjdiag
