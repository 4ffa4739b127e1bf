#pragma once
// A setup in a folder of its own, for tests that read it, changed or not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/error.h"
#include "support/temporary_folder.h"

namespace mjdiag {

/// A setup in which every key occurs.
inline constexpr const char* kEveryKey = R"(schema = "mjdiag.setup/1"
name = "stage"
plant = "plant.xml"
analytic = "analytic.toml"
published = "published.toml"
default_trajectory = "slow"
[rates]
control = 1000.0
substeps = 4
[physics]
gravity = false
static_friction = false
[sensors.q]
element = "encoder"
component = 1
unit = "m"
noise_power = 4e-19
resolution = 1e-9
[sensors.a]
element = "hinge"
unit = "rad"
noise_sd = 3e-8
[actuators.u]
element = "motor"
unit = "N"
limit = 50.0
[actuators.t]
element = "coil"
unit = "N m"
[axes.s]
sensor = "q"
actuator = "u"
drive_gain = 20.5
known_disturbance = "pulse"
feedforward = { snap = 1e-9, acceleration = 0.1, velocity = 0.5 }
feedback = { numerator = [3, -2.5], denominator = [1.0, -0.5] }
limits = { velocity = 0.5, acceleration = 20.0, jerk = 2000.0, snap = 4e5 }
[axes.r]
sensor = "a"
actuator = "t"
nested = { position_gain = 160.0, velocity_gain = 240.0, saturation = 10.0 }
[disturbances.hum]
frequencies = [50.0, 150.0]
amplitude = { u = { ratio = 0.01, maximum = 450.0 } }
[trajectories.fast]
duration = 2.0
period = 1.0
moves = [{ at = 0.1, by = { s = 0.01, r = -0.2 } }, { at = 0.6, by = { s = -0.01 } }]
[trajectories.fast.limits]
s = { velocity = 1.0, acceleration = 30.0, jerk = 3000.0, snap = 5e5 }
r = { velocity = 2.0, acceleration = 40.0, jerk = 4000.0, snap = 6e5 }
[trajectories.slow]
duration = 3.0
moves = [{ at = 0.5, by = { s = 0.02 } }]
[record]
time = { column = "t", unit = "ms" }
[record.channels]
s_ref = { column = "setpoint", unit = "um" }
q = { column = "position" }
u = {}
s_ref_acceleration = { unit = "mm/s^2" }
pulse = { column = "injected", unit = "A", optional = true }
[compare]
skip_samples = 49
low_pass = { order = 4, cutoff = 100.0 }
[compare.forces]
force = { channel = "u", factor = 35.15, unit = "N" }
[diagnosis]
degree = 3
order = 5
cutoff = 60.0
unknown_forces = ["slide", "hinge"]
[diagnosis.thresholds]
margin = 3.0
false_alarms = 0.01
integral_window = 0.125
trajectories = ["slow", "fast"]
[diagnosis.estimation]
rows = 2
sampling = 0.004
horizon = 1.5
forgetting = 0.75
magnitudes = { zeta = 0.02, beta = 0.03 }
[diagnosis.disturbance]
order = 6
cutoff = 200.0
high_pass = { order = 2, cutoff = 40.0 }
segment = 1024
peak_margin = 0.6
total_margin = 0.7
tone_false_alarm = 1e-3
[diagnosis.robust]
degree = 9
order = 10
cutoff = 150.0
runs = 12
[studies.small]
zeta = 1.01
gamma = 0.002
[studies.large]
eta = 0.9
beta = 0.25
)";

/// A folder with a setup and the files that it names.
class SetupFile : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"plant.xml", "analytic.toml", "published.toml"}) {
      temporary_.Write(name, "x");
    }
    Write(kEveryKey);
  }

  void Write(const std::string& text) { temporary_.Write("setup.toml", text); }

  /// The message that ReadSetup throws on the full setup with `from` replaced by `to`.
  std::string MessageWith(const std::string& from, const std::string& to) {
    std::string text = kEveryKey;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    Write(text.replace(at, from.size(), to));
    return Message({});
  }

  std::string Message(const std::vector<std::string>& overrides) {
    try {
      ReadSetup(folder_, overrides);
    } catch (const InputError& error) {
      std::string message = error.what();
      EXPECT_THAT(message, ::testing::Not(::testing::HasSubstr("\n")));
      return message;
    }
    return "nothing thrown";
  }

  /// "<file>:<line>: <rest>"
  std::string At(int line, const std::string& rest) const {
    return (folder_ / "setup.toml").string() + ":" + std::to_string(line) + ": " + rest;
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

}  // namespace mjdiag
