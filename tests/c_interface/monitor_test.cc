// A monitor behind the C interface: what it says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "c_interface/monitor_bench.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using test::CountAllocations;
using ::testing::HasSubstr;

using CMonitor = test::MonitorBench;

TEST_F(CMonitor, NamesItsChannelsAndFaults) {
  const mjdiag_monitor* monitor = Linear();
  const auto names = [&](mjdiag_kind kind) {
    std::vector<std::string> all;
    for (int i = 0; i < mjdiag_monitor_count(monitor, kind); ++i) {
      all.emplace_back(mjdiag_monitor_name(monitor, kind, i));
    }
    return all;
  };
  EXPECT_THAT(names(MJDIAG_OUTPUT), testing::ElementsAre("x", "y", "z"));
  EXPECT_THAT(names(MJDIAG_INPUT), testing::ElementsAre("u_x", "u_y", "u_z"));
  EXPECT_THAT(names(MJDIAG_FAULT),
              testing::ElementsAre("zeta_x", "zeta_y", "beta_x", "beta_y", "eta_x",
                                   "eta_y", "eta_z", "gamma"));
  EXPECT_EQ(mjdiag_monitor_sample_time(monitor), 1.0 / 8000.0);
  EXPECT_EQ(mjdiag_monitor_name(monitor, MJDIAG_FAULT, kFaults), nullptr);
  EXPECT_EQ(mjdiag_monitor_name(monitor, MJDIAG_FAULT, -1), nullptr);
  EXPECT_THAT(LastError(), HasSubstr("no name with number -1"));
}

TEST_F(CMonitor, SaysAtAnyTickWhatItsVerdictSaysAtTheEnd) {
  const Plant plant(1.2);
  mjdiag_monitor* monitor = Nonlinear();
  EXPECT_TRUE(std::isnan(Estimates(monitor)[kFaults]));
  EXPECT_TRUE(std::isnan(Reading(monitor).first_detection));
  EXPECT_THAT(Named(monitor), testing::Each(0));

  mjdiag_instance* machine = plant.Attached();
  Watch(monitor, machine);
  plant.Step(1000);
  const std::vector<double> amid = Estimates(monitor);
  EXPECT_EQ(Reading(monitor).ticks, 1000);
  EXPECT_NEAR(amid[0], 1.2, 5.0 * amid[kFaults]);
  EXPECT_LT(amid[kFaults], 1e-3);
  EXPECT_THAT(Named(monitor), testing::ElementsAre(1, 0, 0, 0, 0, 0, 0, 0));
  plant.Step(3000);
  mjdiag_detach(machine);

  EXPECT_STREQ(mjdiag_monitor_conclude(monitor), "Detected: zeta_x = 1.2.");
  const std::vector<int> named = Named(monitor);
  const std::vector<double> end = Estimates(monitor);
  const json document = Written(monitor);
  for (std::size_t i = 0; i < kFaults; ++i) {
    const json& fault = document["faults"][i];
    EXPECT_EQ(fault["detected"], named[i] == 1) << fault;
    EXPECT_NEAR(fault["value"], end[i], 1e-12) << fault;
    EXPECT_NEAR(fault["sd"], end[kFaults + i], 1e-6 * end[kFaults + i]) << fault;
  }
}

TEST_F(CMonitor, KnowsSinceWhenTheResidualIsOutsideItsLimits) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant(1.2);  // with dry friction besides, too much for linear limits
  Watch(monitor, plant, 2500);
  const mjdiag_reading reading = Reading(monitor);
  const json document = Concluded(monitor);
  EXPECT_EQ(document["first_detection"], reading.first_detection);
  EXPECT_EQ(document["lasting_since"], reading.lasting_since);
  EXPECT_GT(reading.first_detection, 0.0);
  EXPECT_GT(reading.lasting_since, reading.first_detection);
  EXPECT_EQ(reading.lasting_alarm, 1);
  EXPECT_GT(reading.integral, reading.integral_max);
  EXPECT_EQ(document["residual"]["threshold_min"], reading.residual_min);
  EXPECT_EQ(document["residual"]["threshold_max"], reading.residual_max);
  EXPECT_EQ(reading.residual_alarm == 1, reading.residual < reading.residual_min ||
                                             reading.residual > reading.residual_max);
}

TEST_F(CMonitor, BeginsAnewWhenItIsRestarted) {
  std::vector<json> written;
  for (const double zeta_x : {1.1, 1.3, 1.1}) {
    mjdiag_monitor* monitor = Linear();
    EXPECT_EQ(Reading(monitor).ticks, 0);
    Watch(monitor, Plant(zeta_x), 2500);
    written.push_back(Concluded(monitor));
  }
  EXPECT_NE(written[1], written[0]);
  EXPECT_EQ(written[2], written[0]);
}

TEST_F(CMonitor, HearsOnceATick) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  Listen(monitor, plant);
  for (int i = 0; i < 10 * kSubsteps; ++i) {
    mj_step1(plant.model, plant.data);
    EXPECT_EQ(mjdiag_monitor_hear(monitor, plant.model, plant.data), 0);
    mj_step2(plant.model, plant.data);
  }
  EXPECT_EQ(Reading(monitor).ticks, 10);
}

#if !MJDIAG_SANITIZED
TEST_F(CMonitor, DoesNotAllocateInATick) {
  for (mjdiag_monitor* monitor : {Linear(), Nonlinear()}) {
    const Plant plant(1.2);
    // Calls inside the library are counted.
    EXPECT_GT(CountAllocations([&] { mjdiag_monitor_restart(monitor); }), 0);

    mjdiag_instance* machine = plant.Attached();
    Watch(monitor, machine);
    EXPECT_EQ(CountAllocations([&] { plant.Step(600); }), 0);
    EXPECT_EQ(Reading(monitor).ticks, 600);
    mjdiag_detach(machine);

    mjdiag_monitor_restart(monitor);
    Listen(monitor, plant);
    EXPECT_EQ(CountAllocations([&] {
                for (int i = 0; i < 600; ++i) {
                  plant.data->ctrl[0] = i < 50 ? 1.0 : -1.0;
                  plant.Hear(monitor);
                }
              }),
              0);
    EXPECT_EQ(Reading(monitor).ticks, 600);

    mjdiag_monitor_restart(monitor);
    const double y[3] = {1e-6, 0.0, 0.0};
    mjdiag_reading reading;
    double values[kFaults];
    double sd[kFaults];
    mjdiag_monitor_step(monitor, y, 2, y, 3);  // a first refusal keeps its words
    EXPECT_EQ(CountAllocations([&] {
                for (int i = 0; i < 600; ++i) {
                  mjdiag_monitor_step(monitor, y, 3, y, 3);
                  mjdiag_monitor_read(monitor, &reading);
                  mjdiag_monitor_estimates(monitor, values, sd, kFaults);
                  mjdiag_monitor_step(monitor, y, 2, y, 3);
                }
              }),
              0);
    EXPECT_EQ(reading.ticks, 600);
  }
}
#endif

}  // namespace
}  // namespace mjdiag
