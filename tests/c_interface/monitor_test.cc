// A monitor behind the C interface: what it says, and what it refuses.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/command_line.h"
#include "mjdiag.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using test::CountAllocations;
using ::testing::HasSubstr;

constexpr const char* kSetup = MJDIAG_SOURCE_DIR "/mjcf/ab383";
constexpr int kRoom = 4000;
constexpr int kFaults = 8;
constexpr int kSubsteps = 4;

std::string LastError() { return mjdiag_last_error(); }

/// The bonder, with or without a fault.
struct Plant {
  explicit Plant(double zeta_x = 1.0) {
    char error[500] = "";
    model = mj_loadXML((std::string(kSetup) + "/plant.xml").c_str(), nullptr, error,
                       sizeof error);
    EXPECT_EQ(mjdiag_prepare(model, kSetup), 0) << mjdiag_last_error();
    EXPECT_EQ(mjdiag_set_fault(model, "zeta_x", zeta_x), 0);
    data = mj_makeData(model);
    EXPECT_EQ(mjdiag_rest(model, data, kSetup), 0) << mjdiag_last_error();
  }
  ~Plant() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  mjdiag_instance* Attached() const {
    mjdiag_instance* machine = mjdiag_attach(model, data, kSetup, "xyz", 1);
    EXPECT_NE(machine, nullptr) << mjdiag_last_error();
    return machine;
  }
  void Step(int ticks) const {
    for (int i = 0; i < ticks * kSubsteps; ++i) mj_step(model, data);
  }
  /// A tick to which a monitor listens.
  int Hear(mjdiag_monitor* monitor) const {
    mj_step1(model, data);
    const int status = mjdiag_monitor_hear(monitor, model, data);
    mj_step2(model, data);
    for (int i = 1; i < kSubsteps; ++i) mj_step(model, data);
    return status;
  }

  mjModel* model = nullptr;
  mjData* data = nullptr;
};

class CMonitor : public ::testing::Test {
 protected:
  /// Of the machine as linear, made once for all tests of this process.
  static mjdiag_monitor* Linear() {
    static mjdiag_monitor* const monitor =
        mjdiag_monitor_open(kSetup, nullptr, 1, kRoom);
    EXPECT_EQ(mjdiag_monitor_restart(monitor), 0) << mjdiag_last_error();
    return monitor;
  }
  /// The same of the machine with its dry friction.
  static mjdiag_monitor* Nonlinear() {
    static mjdiag_monitor* const monitor =
        mjdiag_monitor_open(kSetup, nullptr, 0, kRoom);
    EXPECT_EQ(mjdiag_monitor_restart(monitor), 0) << mjdiag_last_error();
    return monitor;
  }
  static int Feed(mjdiag_monitor* monitor, double reading) {
    const std::vector<double> y{reading, 0.0, 0.0};
    const std::vector<double> u{0.0, 0.0, 0.0};
    return mjdiag_monitor_step(monitor, y.data(), 3, u.data(), 3);
  }
  static mjdiag_reading Reading(const mjdiag_monitor* monitor) {
    mjdiag_reading reading;
    EXPECT_EQ(mjdiag_monitor_read(monitor, &reading), 0) << mjdiag_last_error();
    return reading;
  }
  static std::vector<double> Estimates(const mjdiag_monitor* monitor) {
    std::vector<double> both(2 * kFaults);
    EXPECT_EQ(
        mjdiag_monitor_estimates(monitor, both.data(), both.data() + kFaults, kFaults),
        0)
        << mjdiag_last_error();
    return both;
  }
  /// Of a monitor that watches the bonder follow "xyz" for that many ticks.
  static void Watch(mjdiag_monitor* monitor, const Plant& plant, int ticks) {
    mjdiag_instance* machine = plant.Attached();
    ASSERT_EQ(mjdiag_monitor_watch(monitor, machine), 0) << mjdiag_last_error();
    plant.Step(ticks);
    mjdiag_detach(machine);
  }
  json Written(const mjdiag_monitor* monitor) const {
    const std::string file = (folder_ / "diagnosis.json").string();
    EXPECT_EQ(mjdiag_monitor_write(monitor, file.c_str()), 0) << mjdiag_last_error();
    return json::parse(ReadAll(file));
  }

  const test::TemporaryFolder folder_;
};

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
  std::vector<int> named(kFaults, -1);
  EXPECT_EQ(mjdiag_monitor_named(monitor, named.data(), kFaults), 0);
  EXPECT_THAT(named, testing::Each(0));

  mjdiag_instance* machine = plant.Attached();
  ASSERT_EQ(mjdiag_monitor_watch(monitor, machine), 0) << mjdiag_last_error();
  plant.Step(1000);
  const std::vector<double> amid = Estimates(monitor);
  EXPECT_EQ(Reading(monitor).ticks, 1000);
  EXPECT_NEAR(amid[0], 1.2, 5.0 * amid[kFaults]);
  EXPECT_LT(amid[kFaults], 1e-3);
  EXPECT_EQ(mjdiag_monitor_named(monitor, named.data(), kFaults), 0);
  EXPECT_THAT(named, testing::ElementsAre(1, 0, 0, 0, 0, 0, 0, 0));
  plant.Step(3000);
  mjdiag_detach(machine);

  EXPECT_STREQ(mjdiag_monitor_conclude(monitor), "Detected: zeta_x = 1.2.");
  EXPECT_EQ(mjdiag_monitor_named(monitor, named.data(), kFaults), 0);
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
  ASSERT_NE(mjdiag_monitor_conclude(monitor), nullptr) << mjdiag_last_error();
  const json document = Written(monitor);
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
    ASSERT_NE(mjdiag_monitor_conclude(monitor), nullptr) << mjdiag_last_error();
    written.push_back(Written(monitor));
  }
  EXPECT_NE(written[1], written[0]);
  EXPECT_EQ(written[2], written[0]);
}

TEST_F(CMonitor, HearsOnceATick) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0) << mjdiag_last_error();
  for (int i = 0; i < 10 * kSubsteps; ++i) {
    mj_step1(plant.model, plant.data);
    EXPECT_EQ(mjdiag_monitor_hear(monitor, plant.model, plant.data), 0);
    mj_step2(plant.model, plant.data);
  }
  EXPECT_EQ(Reading(monitor).ticks, 10);
}

TEST_F(CMonitor, EndsItsRunWhereATickIsMissing) {
  for (const double jump : {1.5, -2.0}) {
    mjdiag_monitor* monitor = Linear();
    const Plant plant;
    ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0) << mjdiag_last_error();
    EXPECT_EQ(plant.Hear(monitor), 0);
    EXPECT_EQ(plant.Hear(monitor), 0);
    plant.data->time += jump * mjdiag_monitor_sample_time(monitor);
    EXPECT_NE(plant.Hear(monitor), 0);
    EXPECT_THAT(LastError(), HasSubstr("has not moved by a control tick"));
    EXPECT_NE(plant.Hear(monitor), 0);
    EXPECT_EQ(Reading(monitor).ticks, 2);
  }
}

TEST_F(CMonitor, EndsItsRunAtAReadingThatIsNoNumber) {
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

TEST_F(CMonitor, SurvivesReadingsThatNoMachineHas) {
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

TEST_F(CMonitor, ConcludesNoRunThatItHasNoRoomFor) {
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

TEST_F(CMonitor, RefusesAMotionThatShowsNothing) {
  for (const int ticks : {1, 2, 100, 2500}) {
    mjdiag_monitor* monitor = Linear();
    for (int i = 0; i < ticks; ++i) EXPECT_EQ(Feed(monitor, 0.0), 0);
    EXPECT_EQ(mjdiag_monitor_conclude(monitor), nullptr) << ticks;
    EXPECT_NE(LastError(), "");
  }
}

TEST_F(CMonitor, RefusesToOpenWhatIsNotThere) {
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

TEST_F(CMonitor, RefusesNullPointers) {
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
  ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0);
  EXPECT_NE(mjdiag_monitor_hear(monitor, plant.model, nullptr), 0);
  EXPECT_NE(mjdiag_monitor_hear(monitor, nullptr, plant.data), 0);
  mjdiag_monitor_close(nullptr);
  mjdiag_detach(nullptr);
  EXPECT_EQ(mjdiag_monitor_estimates(monitor, values, nullptr, kFaults), 0);
  mjdiag_detach(machine);
}

TEST_F(CMonitor, RefusesHandlesThatAreClosed) {
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
  ASSERT_EQ(mjdiag_monitor_watch(monitor, next), 0) << mjdiag_last_error();
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

TEST_F(CMonitor, RefusesCallsInTheWrongOrder) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  const Plant other;
  EXPECT_NE(mjdiag_monitor_write(monitor, "diagnosis.json"), 0);
  EXPECT_THAT(LastError(), HasSubstr("not concluded"));
  EXPECT_NE(plant.Hear(monitor), 0);
  EXPECT_THAT(LastError(), HasSubstr("does not listen"));

  // One source at a time.
  ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0) << mjdiag_last_error();
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

TEST_F(CMonitor, RefusesAModelThatIsNotTheSetupS) {
  mjdiag_monitor* monitor = Linear();
  const Plant plant;
  plant.model->opt.timestep *= 2.0;
  EXPECT_NE(mjdiag_monitor_listen(monitor, plant.model), 0);
  EXPECT_THAT(LastError(), HasSubstr("time step"));
}

#if MJDIAG_COUNTS_ALLOCATIONS
TEST_F(CMonitor, DoesNotAllocateInATick) {
  for (mjdiag_monitor* monitor : {Linear(), Nonlinear()}) {
    const Plant plant(1.2);
    // Calls inside the library are counted.
    EXPECT_GT(CountAllocations([&] { mjdiag_monitor_restart(monitor); }), 0);

    mjdiag_instance* machine = plant.Attached();
    ASSERT_EQ(mjdiag_monitor_watch(monitor, machine), 0) << mjdiag_last_error();
    EXPECT_EQ(CountAllocations([&] { plant.Step(600); }), 0);
    EXPECT_EQ(Reading(monitor).ticks, 600);
    mjdiag_detach(machine);

    mjdiag_monitor_restart(monitor);
    ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0) << mjdiag_last_error();
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
