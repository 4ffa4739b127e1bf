#include "mjdiag/discovery/answer/split_run.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

TEST(SplitRun, LeavesTheEndOfASingleRecordUnseen) {
  const test::Arm arm;
  const Measurements measurements =
      MeasurementsOf(arm.machine, test::Arm::Measure(), nullptr);
  const SplitRun run = Split(measurements, 0.7);
  const Eigen::Index samples = measurements.fit.front().record.samples();
  EXPECT_EQ(run.seen.samples(), run.first_unseen);
  EXPECT_EQ(run.unseen.samples(), samples) << "a filter comes there from its beginning";
  EXPECT_NEAR(run.share, 0.7, 1.0 / static_cast<double>(samples));
}

TEST(SplitRun, LeavesRecordsForValidationUnseenAndFitsAllOfTheOthers) {
  const test::Arm arm;
  const Record record = test::Arm::Measure();
  const SplitRun run = Split(MeasurementsOf(arm.machine, record, &record), 0.7);
  EXPECT_EQ(run.seen.samples(), record.samples());
  EXPECT_EQ(run.unseen.samples(), record.samples());
  EXPECT_EQ(run.first_unseen, 0);
  EXPECT_EQ(run.share, 1.0);
}

TEST(SplitRun, RefusesARecordWithAPlantOfItsOwn) {
  const test::Arm arm;
  Measurements measurements =
      MeasurementsOf(arm.machine, test::Arm::Measure(), nullptr);
  measurements.fit.front().own_plant = true;
  EXPECT_THROW(Split(measurements, 0.7), InputError);
}

}  // namespace
}  // namespace mjdiag
