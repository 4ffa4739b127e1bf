// A monitor behind the C interface: what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "c_interface/monitor_bench.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

using CRefusals = test::MonitorBench;

TEST_F(CRefusals, EndsItsRunWhereATickIsMissing) {
  for (const double jump : {1.5, -2.0}) {
    mjdiag_monitor* monitor = Linear();
    const Plant plant;
    Listen(monitor, plant);
    EXPECT_EQ(plant.Hear(monitor), 0);
    EXPECT_EQ(plant.Hear(monitor), 0);
    plant.data->time += jump * mjdiag_monitor_sample_time(monitor);
    EXPECT_NE(plant.Hear(monitor), 0);
    EXPECT_THAT(LastError(), HasSubstr("has not moved by a control tick"));
    EXPECT_NE(plant.Hear(monitor), 0);
    EXPECT_EQ(Reading(monitor).ticks, 2);
  }
}

TEST_F(CRefusals, EndsItsRunAtAReadingThatIsNoNumber) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    mjdiag_monitor* monitor = Linear();
    for (int i = 0; i < 100; ++i) EXPECT_EQ(Feed(monitor, 0.0), 0);
    const mjdiag_reading before = Reading(monitor);
    EXPECT_NE(Feed(monitor, bad), 0);
    EXPECT_THAT(LastError(), HasSubstr("no finite number"));
    EXPECT_NE(Feed(monitor, 0.0), 0);
    EXPECT_EQ(Reading(monitor).ticks, 100);
    EXPECT_EQ(Reading(monitor).residual, before.residual);
    EXPECT_EQ(mjdiag_monitor_restart(monitor), 0);
    EXPECT_EQ(Feed(monitor, 0.0), 0);
    EXPECT_EQ(Reading(monitor).ticks, 1);
  }
}

TEST_F(CRefusals, SurvivesReadingsThatNoMachineHas) {
  for (mjdiag_monitor* monitor : {Linear(), Nonlinear()}) {
    for (const double reading : {1e300, -1e300, 1e-300, 0.0}) {
      for (int i = 0; i < 200; ++i) EXPECT_EQ(Feed(monitor, reading), 0);
    }
    Estimates(monitor);
    std::vector<int> named(kFaults);
    mjdiag_monitor_named(monitor, named.data(), kFaults);
    mjdiag_monitor_conclude(monitor);
  }
}

TEST_F(CRefusals, ConcludesNoRunThatItHasNoRoomFor) {
  mjdiag_monitor* monitor = Linear();
  EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("no ticks"));
  for (int i = 0; i < kRoom + 1; ++i) EXPECT_EQ(Feed(monitor, 0.0), 0);
  EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("4001 ticks, opened with room for 4000"));
  // It runs on nevertheless.
  EXPECT_EQ(Feed(monitor, 0.0), 0);
  EXPECT_EQ(Reading(monitor).ticks, kRoom + 2);
}

TEST_F(CRefusals, RefusesAMotionThatShowsNothing) {
  for (const int ticks : {1, 2, 100, 2500}) {
    mjdiag_monitor* monitor = Linear();
    for (int i = 0; i < ticks; ++i) EXPECT_EQ(Feed(monitor, 0.0), 0);
    EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr) << ticks;
    EXPECT_NE(LastError(), "");
  }
}

TEST_F(CRefusals, RefusesToOpenWhatIsNotThere) {
  EXPECT_EQ(mjdiag_monitor_open(nullptr, nullptr, 0, kRoom), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("neither setup nor filters"));
  EXPECT_EQ(mjdiag_monitor_open("/no/such/folder", nullptr, 0, kRoom), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("/no/such/folder"));
  EXPECT_EQ(mjdiag_monitor_open(nullptr, "/no/such/file", 0, kRoom), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("/no/such/file"));
  EXPECT_EQ(mjdiag_monitor_open(kSetup, nullptr, 1, -1), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("room for -1 ticks"));
  EXPECT_EQ(
      mjdiag_monitor_open(kSetup, nullptr, 1, std::numeric_limits<int64_t>::max()),
      nullptr);
}

// Friction that the plant carries would come twice.
TEST_F(CRefusals, RefusesToPrepareAModelTwice) {
  const Plant plant;
  EXPECT_NE(mjdiag_prepare(plant.model, kSetup), 0);
  EXPECT_THAT(mjdiag_last_error(), HasSubstr("prepared already"));
}

TEST_F(CRefusals, RefusesNullPointers) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  mjdiag_instance* machine = plant.Attached();
  const double y[3] = {0.0, 0.0, 0.0};
  mjdiag_reading reading;
  int named[kFaults];
  double values[kFaults];

  const std::vector<std::function<bool()>> refusals{
      [&] { return mjdiag_prepare(nullptr, kSetup) != 0; },
      [&] { return mjdiag_prepare(plant.model, nullptr) != 0; },
      [&] { return mjdiag_set_fault(nullptr, "zeta_x", 1.0) != 0; },
      [&] { return mjdiag_set_fault(plant.model, nullptr, 1.0) != 0; },
      [&] { return mjdiag_rest(nullptr, plant.data, kSetup) != 0; },
      [&] { return mjdiag_rest(plant.model, nullptr, kSetup) != 0; },
      [&] { return mjdiag_rest(plant.model, plant.data, nullptr) != 0; },
      [&] { return !mjdiag_attach(nullptr, plant.data, kSetup, "x", 1); },
      [&] { return !mjdiag_attach(plant.model, nullptr, kSetup, "x", 1); },
      [&] { return !mjdiag_attach(plant.model, plant.data, nullptr, "x", 1); },
      [&] { return mjdiag_ticks(nullptr) < 0; },
      [&] { return mjdiag_write_record(nullptr, "r.csv") != 0; },
      [&] { return mjdiag_write_record(machine, nullptr) != 0; },
      [&] { return mjdiag_monitor_count(nullptr, MJDIAG_FAULT) < 0; },
      [&] { return !mjdiag_monitor_name(nullptr, MJDIAG_FAULT, 0); },
      [&] { return mjdiag_monitor_sample_time(nullptr) < 0.0; },
      [&] { return mjdiag_monitor_watch(nullptr, machine) != 0; },
      [&] { return mjdiag_monitor_watch(monitor, nullptr) != 0; },
      [&] { return mjdiag_monitor_listen(nullptr, plant.model) != 0; },
      [&] { return mjdiag_monitor_listen(monitor, nullptr) != 0; },
      [&] { return mjdiag_monitor_hear(nullptr, plant.model, plant.data) != 0; },
      [&] { return mjdiag_monitor_hear(monitor, nullptr, plant.data) != 0; },
      [&] { return mjdiag_monitor_hear(monitor, plant.model, nullptr) != 0; },
      [&] { return mjdiag_monitor_step(nullptr, y, 3, y, 3) != 0; },
      [&] { return mjdiag_monitor_step(monitor, nullptr, 3, y, 3) != 0; },
      [&] { return mjdiag_monitor_step(monitor, y, 3, nullptr, 3) != 0; },
      [&] { return mjdiag_monitor_step(monitor, y, -3, y, 3) != 0; },
      [&] { return mjdiag_monitor_step(monitor, y, 2, y, 3) != 0; },
      [&] { return mjdiag_monitor_read(nullptr, &reading) != 0; },
      [&] { return mjdiag_monitor_read(monitor, nullptr) != 0; },
      [&] { return mjdiag_monitor_estimates(nullptr, values, values, kFaults) != 0; },
      [&] { return mjdiag_monitor_estimates(monitor, nullptr, values, kFaults) != 0; },
      [&] { return mjdiag_monitor_estimates(monitor, values, values, 7) != 0; },
      [&] { return mjdiag_monitor_named(nullptr, named, kFaults) != 0; },
      [&] { return mjdiag_monitor_named(monitor, nullptr, kFaults) != 0; },
      [&] { return mjdiag_monitor_named(monitor, named, -1) != 0; },
      [&] { return !mjdiag_monitor_conclude(nullptr); },
      [&] { return mjdiag_monitor_write(nullptr, "d.json") != 0; },
      [&] { return mjdiag_monitor_write(monitor, nullptr) != 0; },
      [&] { return mjdiag_monitor_restart(nullptr) != 0; },
  };
  for (std::size_t i = 0; i < refusals.size(); ++i) {
    EXPECT_EQ(mjdiag_monitor_read(monitor, &reading), 0);  // clears the last error
    EXPECT_TRUE(refusals[i]()) << i;
    EXPECT_NE(LastError(), "") << i;
  }
  Listen(monitor, plant);
  EXPECT_NE(mjdiag_monitor_hear(monitor, plant.model, nullptr), 0);
  EXPECT_NE(mjdiag_monitor_hear(monitor, nullptr, plant.data), 0);
  mjdiag_monitor_close(nullptr);
  mjdiag_detach(nullptr);
  EXPECT_EQ(mjdiag_monitor_estimates(monitor, values, nullptr, kFaults), 0);
  mjdiag_detach(machine);
}

TEST_F(CRefusals, RefusesHandlesThatAreClosed) {
  const Plant plant;
  mjdiag_instance* machine = plant.Attached();
  mjdiag_instance* const second =
      mjdiag_attach(plant.model, plant.data, kSetup, "x", 1);
  EXPECT_EQ(second, nullptr);
  EXPECT_THAT(LastError(), HasSubstr("an instance is attached to it"));
  mjdiag_detach(machine);
  mjdiag_detach(machine);
  EXPECT_LT(mjdiag_ticks(machine), 0);
  EXPECT_THAT(LastError(), HasSubstr("a handle that is closed"));
  EXPECT_NE(mjdiag_write_record(machine, "r.csv"), 0);
  EXPECT_NE(mjdiag_monitor_watch(Linear(), machine), 0);
  // The handle of the one that follows is another.
  mjdiag_instance* next = plant.Attached();
  mjdiag_detach(machine);
  EXPECT_EQ(mjdiag_ticks(next), 0);

  mjdiag_monitor* monitor = mjdiag_monitor_open(kSetup, nullptr, 1, 0);
  Watch(monitor, next);
  plant.Step(1);
  EXPECT_EQ(Reading(monitor).ticks, 1);
  mjdiag_monitor_close(monitor);
  mjdiag_monitor_close(monitor);
  plant.Step(1);  // the instance runs on unwatched
  EXPECT_EQ(mjdiag_ticks(next), 2);
  EXPECT_NE(Feed(monitor, 0.0), 0);
  EXPECT_NE(mjdiag_monitor_hear(monitor, plant.model, plant.data), 0);
  EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr);
  EXPECT_NE(mjdiag_monitor_restart(monitor), 0);
  EXPECT_LT(mjdiag_monitor_count(monitor, MJDIAG_FAULT), 0);
  mjdiag_detach(next);
}

TEST_F(CRefusals, RefusesCallsInTheWrongOrder) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  const Plant other;
  EXPECT_NE(mjdiag_monitor_write(monitor, "diagnosis.json"), 0);
  EXPECT_THAT(LastError(), HasSubstr("not concluded"));
  EXPECT_NE(plant.Hear(monitor), 0);
  EXPECT_THAT(LastError(), HasSubstr("does not listen"));

  // One source at a time.
  Listen(monitor, plant);
  EXPECT_NE(mjdiag_monitor_listen(monitor, other.model), 0);
  EXPECT_NE(other.Hear(monitor), 0);
  EXPECT_NE(Feed(monitor, 0.0), 0);
  EXPECT_THAT(LastError(), HasSubstr("come from somewhere else"));
  ASSERT_EQ(mjdiag_monitor_restart(monitor), 0);
  EXPECT_EQ(Feed(monitor, 0.0), 0);
  EXPECT_NE(mjdiag_monitor_listen(monitor, plant.model), 0);
  mjdiag_instance* machine = plant.Attached();
  EXPECT_NE(mjdiag_monitor_watch(monitor, machine), 0);

  // One monitor an instance, which a restart sets free.
  ASSERT_EQ(mjdiag_monitor_restart(monitor), 0);
  EXPECT_EQ(mjdiag_monitor_watch(monitor, machine), 0) << mjdiag_last_error();
  EXPECT_NE(mjdiag_monitor_watch(monitor, machine), 0);
  mjdiag_monitor* rival = mjdiag_monitor_open(kSetup, nullptr, 1, 0);
  EXPECT_NE(mjdiag_monitor_watch(rival, machine), 0);
  EXPECT_THAT(LastError(), HasSubstr("another monitor watches it"));
  plant.Step(3);
  ASSERT_EQ(mjdiag_monitor_restart(monitor), 0);
  plant.Step(3);
  EXPECT_EQ(Reading(monitor).ticks, 0);
  EXPECT_EQ(mjdiag_monitor_watch(rival, machine), 0) << mjdiag_last_error();
  mjdiag_monitor_close(rival);

  // A run that is concluded has ended, also where nothing could be concluded.
  EXPECT_EQ(Feed(monitor, 0.0), 0);
  EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr);
  EXPECT_NE(Feed(monitor, 0.0), 0);
  EXPECT_THAT(LastError(), HasSubstr("is concluded"));
  mjdiag_detach(machine);
}

TEST_F(CRefusals, RefusesAModelThatIsNotTheSetupS) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  plant.model->opt.timestep *= 2.0;
  EXPECT_NE(mjdiag_monitor_listen(monitor, plant.model), 0);
  EXPECT_THAT(LastError(), HasSubstr("time step"));
}

}  // namespace
}  // namespace mjdiag
