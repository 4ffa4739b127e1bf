#include "mjdiag/discovery/answer/split_run.h"

#include <gtest/gtest.h>

#include "support/arm.h"

namespace mjdiag {
namespace {

TEST(SplitRun, LeavesTheEndOfASingleRecordUnseen) {
  const test::Arm arm;
  const Measurements measurements =
      MeasurementsOf(arm.machine, test::Arm::Measure(), nullptr);
  const SplitRun run = Split(measurements, 0.7);
  const Eigen::Index samples = measurements.fit.front().record.samples();
  EXPECT_EQ(run.seen.samples(), run.seen_of.front());
  EXPECT_EQ(run.New().count(), samples - run.seen_of.front());
  EXPECT_EQ(run.unseen.samples(), samples) << "a filter comes there from its beginning";
  EXPECT_NEAR(run.share, 0.7, 1.0 / static_cast<double>(samples));
}

TEST(SplitRun, LeavesRecordsForValidationUnseenAndFitsAllOfTheOthers) {
  const test::Arm arm;
  const Record record = test::Arm::Measure();
  const SplitRun run = Split(MeasurementsOf(arm.machine, record, &record), 0.7);
  EXPECT_EQ(run.seen.samples(), record.samples());
  EXPECT_EQ(run.unseen.samples(), record.samples());
  EXPECT_FALSE(run.GoesOn());
  EXPECT_TRUE(run.New().all());
  EXPECT_EQ(run.share, 1.0);
}

TEST(SplitRun, LeavesTheEndOfEveryRecordUnseenForEachMayShowSomethingOfItsOwn) {
  const test::Arm arm;
  const Record record = test::Arm::Measure();
  Measurements measurements = MeasurementsOf(arm.machine, record, nullptr);
  measurements.fit.push_back(measurements.fit.front());
  const SplitRun run = Split(measurements, 0.7);
  ASSERT_EQ(run.seen.records.size(), 2u);
  EXPECT_EQ(run.seen.records[1].sample, run.seen_of[0]);
  EXPECT_EQ(run.unseen.records[1].sample, record.samples());
  const SampleMask is_new = run.New();
  EXPECT_FALSE(is_new[record.samples()]) << "the second record begins there";
  EXPECT_TRUE(is_new[2 * record.samples() - 1]);
  EXPECT_NEAR(run.share, 0.7, 1.0 / static_cast<double>(record.samples()));
}

}  // namespace
}  // namespace mjdiag
