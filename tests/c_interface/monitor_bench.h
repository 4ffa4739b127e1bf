#pragma once
// What tests of the C interface share: the bonder, a folder, and monitors.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "mjdiag.h"

namespace mjdiag::test {

class BonderBench : public ::testing::Test {
 protected:
  static constexpr const char* kSetup = MJDIAG_SOURCE_DIR "/mjcf/ab383";
  static constexpr int kFaults = 8;
  static constexpr int kSubsteps = 4;

  /// Of a file in the folder of the test.
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Read(const std::string& name) const { return ReadAll(folder_ / name); }
  nlohmann::json ReadJson(const std::string& name) const {
    return nlohmann::json::parse(Read(name));
  }

  const TemporaryFolder folder_;
};

class MonitorBench : public BonderBench {
 protected:
  static constexpr int kRoom = 4000;

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

    /// The controllers that let it follow "xyz".
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

  static std::string LastError() { return mjdiag_last_error(); }

  /// Of the machine as linear, made once for all tests of this process.
  static mjdiag_monitor* Linear() {
    static mjdiag_monitor* const monitor =
        mjdiag_monitor_open(kSetup, nullptr, 1, kRoom);
    return Restarted(monitor);
  }
  /// The same of the machine with its dry friction.
  static mjdiag_monitor* Nonlinear() {
    static mjdiag_monitor* const monitor =
        mjdiag_monitor_open(kSetup, nullptr, 0, kRoom);
    return Restarted(monitor);
  }

  static int Feed(mjdiag_monitor* monitor, double reading) {
    const std::vector<double> y{reading, 0.0, 0.0};
    const std::vector<double> u{0.0, 0.0, 0.0};
    return mjdiag_monitor_step(monitor, y.data(), 3, u.data(), 3);
  }
  static void Listen(mjdiag_monitor* monitor, const Plant& plant) {
    ASSERT_EQ(mjdiag_monitor_listen(monitor, plant.model), 0) << mjdiag_last_error();
  }
  static void Watch(mjdiag_monitor* monitor, mjdiag_instance* machine) {
    ASSERT_EQ(mjdiag_monitor_watch(monitor, machine), 0) << mjdiag_last_error();
  }
  /// Lets it watch the bonder follow "xyz" for that many ticks.
  static void Watch(mjdiag_monitor* monitor, const Plant& plant, int ticks) {
    mjdiag_instance* machine = plant.Attached();
    Watch(monitor, machine);
    plant.Step(ticks);
    mjdiag_detach(machine);
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
  static std::vector<int> Named(const mjdiag_monitor* monitor) {
    std::vector<int> named(kFaults, -1);
    EXPECT_EQ(mjdiag_monitor_named(monitor, named.data(), kFaults), 0)
        << mjdiag_last_error();
    return named;
  }
  /// What it writes when it has concluded.
  nlohmann::json Concluded(mjdiag_monitor* monitor) const {
    EXPECT_NE(mjdiag_monitor_conclude(monitor), nullptr) << mjdiag_last_error();
    return Written(monitor);
  }
  nlohmann::json Written(const mjdiag_monitor* monitor) const {
    EXPECT_EQ(mjdiag_monitor_write(monitor, Path("diagnosis.json").c_str()), 0)
        << mjdiag_last_error();
    return ReadJson("diagnosis.json");
  }

 private:
  static mjdiag_monitor* Restarted(mjdiag_monitor* monitor) {
    EXPECT_EQ(mjdiag_monitor_restart(monitor), 0) << mjdiag_last_error();
    return monitor;
  }
};

}  // namespace mjdiag::test
