// Records of machines without a controller, which may begin anywhere.

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/discovery/comparison/comparison.h"
#include "support/any_machine.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

constexpr double kNoise = 1e-4;  // [rad]

/// Four seconds of a joint about a level axis.
struct Lever {
  explicit Lever(const std::string& joint, const std::string& centre)
      : machine(test::MachineOf(
            "<mujoco><option timestep=\"0.001\" tolerance=\"1e-12\"/><worldbody><body>"
            "<joint name=\"q\" axis=\"0 1 0\" " +
                joint + "/><inertial pos=\"" + centre +
                "\" mass=\"1\" diaginertia=\"0.02 0.02 0.01\"/></body></worldbody>"
                "<actuator><motor name=\"u\" joint=\"q\"/></actuator>"
                "<sensor><jointpos name=\"q\" joint=\"q\"/></sensor></mujoco>",
            "[rates]\ncontrol = 500.0\nsubsteps = 2\n[sensors.q]\nelement = \"q\"\n"
            "unit = \"rad\"\n[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n")) {}

  Record Measure(const std::vector<std::string>& hidden = {},
                 double start = 0.0) const {
    const Eigen::Index samples = 2000;
    const Eigen::VectorXd t = VectorOfTimes(samples);
    Record inputs(0.002);
    inputs.Add(
        {"u", "N m", 0.6 * (4.0 * t.array()).sin() + 0.3 * (11.0 * t.array()).sin()});
    Excitation excitation;
    excitation.inputs = inputs;
    excitation.start["q"] = start;
    RunOptions options;
    options.seed = 3;
    return Simulate(machine.With(test::With(hidden))
                        .WithSensorNoise(Eigen::VectorXd::Constant(1, kNoise)),
                    excitation, options);
  }
  static Eigen::VectorXd VectorOfTimes(Eigen::Index samples) {
    return 0.002 *
           Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  }

  Machine machine;
};

// A pendulum whose record was switched on while it swung.
TEST(CompareOpenLoop, BeginsInTheMotionThatARecordBeginsIn) {
  const Lever lever("damping=\"0.05\"", "0 0 -0.3");
  const Comparison comparison =
      Compare(lever.machine, lever.Measure().Slice(617, 1200), {});
  ASSERT_FALSE(comparison.falls);
  EXPECT_FALSE(comparison.exceeds_noise());
  EXPECT_NEAR(comparison.channels.at(0).rms, kNoise, 0.15 * kNoise);
}

// Where nothing pulls it back a machine that begins at one noisy reading stays beside it.
TEST(CompareOpenLoop, BeginsWhereAllReadingsSayAndNotAtTheFirst) {
  const Lever lever("damping=\"0.5\"", "0 0 0");
  const Record measured = lever.Measure({}, 0.3);
  Record shifted(measured.sample_time());
  for (Channel channel : measured.channels()) {
    if (channel.name == "q") channel.samples[0] += 3.0 * kNoise;
    shifted.Add(std::move(channel));
  }
  const Comparison comparison = Compare(lever.machine, shifted, {});
  EXPECT_FALSE(comparison.exceeds_noise());
  EXPECT_NEAR(comparison.channels.at(0).rms, kNoise, 0.15 * kNoise);
}

// The noise floor of a plant that runs away is that of its sensors, whatever it lacks.
TEST(CompareOpenLoop, SaysOfAMachineThatRunsAwayWhetherItLacksAnything) {
  const Lever lever("", "0 0 0");
  const Comparison lacks =
      Compare(lever.machine, lever.Measure({"coulomb_friction@q:force=0.3"}), {});
  ASSERT_TRUE(lacks.falls);
  EXPECT_LT(lacks.channels.at(0).noise_floor.rms, 1.5 * kNoise);
  EXPECT_TRUE(lacks.exceeds_noise());
}

}  // namespace
}  // namespace mjdiag
