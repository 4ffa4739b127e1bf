#pragma once
// What tests of the C interface share: the bonder, and monitors of it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "mjdiag.h"

namespace mjdiag::test {

inline constexpr const char* kSetup = MJDIAG_SOURCE_DIR "/mjcf/ab383";
inline constexpr int kRoom = 4000;
inline constexpr int kFaults = 8;
inline constexpr int kSubsteps = 4;

inline std::string LastError() { return mjdiag_last_error(); }

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

class MonitorBench : public ::testing::Test {
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
  nlohmann::json Written(const mjdiag_monitor* monitor) const {
    const std::string file = (folder_ / "diagnosis.json").string();
    EXPECT_EQ(mjdiag_monitor_write(monitor, file.c_str()), 0) << mjdiag_last_error();
    return nlohmann::json::parse(ReadAll(file));
  }

  const TemporaryFolder folder_;
};

}  // namespace mjdiag::test
