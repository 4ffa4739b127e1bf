#include "mjdiag/plugin/runtime/tick_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "mjdiag/signals/error.h"
#include "support/count_allocations.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::HasSubstr;

mjdiag::Setup Emps() { return ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"); }
mjdiag::Setup Bonder() { return ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"); }

/// Without controllers: u = 0.1 k.
struct OpenLoop {
  explicit OpenLoop(Index samples) {
    setup.control.axes.clear();
    ramp.inputs = Record(setup.rates.tick());
    ramp.inputs.Add({"u", "V",
                     Eigen::VectorXd::LinSpaced(
                         samples, 0.0, 0.1 * static_cast<double>(samples - 1))});
  }
  mjdiag::Setup setup = Emps();
  Excitation ramp;
};

double Tick(TickLoop& loop, double reading) {
  const std::array outputs{reading};
  std::array inputs{0.0};
  loop.Tick(outputs, inputs);
  return inputs[0];
}

TEST(TickLoop, PlaysTheRecordedInputsAndThenHoldsTheLast) {
  const OpenLoop bench(5);
  TickLoop loop(bench.setup, bench.ramp, {});
  EXPECT_EQ(loop.ticks(), 5);
  for (int k = 0; k < 8; ++k) {
    EXPECT_EQ(Tick(loop, 0.01 * k), bench.ramp.inputs.At("u").samples[std::min(k, 4)]);
    EXPECT_EQ(loop.ticks_done(), k + 1);
    EXPECT_EQ(loop.ToRecord().samples(), std::min(k + 1, 5));
  }
  const Record record = loop.ToRecord();
  EXPECT_EQ(record.sample_time(), bench.setup.rates.tick());
  EXPECT_EQ(record.At("u").samples, bench.ramp.inputs.At("u").samples);
  // What was read beyond the end is not in it.
  EXPECT_EQ(record.At("q").samples[4], 0.04);
  EXPECT_EQ(record.At("q").unit, "m");
}

TEST(TickLoop, ClampsCommandsToTheLimitOfTheActuator) {
  OpenLoop bench(5);
  bench.setup.channels.actuators[0].limit = 0.25;
  TickLoop loop(bench.setup, bench.ramp, {});
  for (const double expected : {0.0, 0.1, 0.2, 0.25, 0.25}) {
    EXPECT_DOUBLE_EQ(Tick(loop, 0.0), expected);
  }
  EXPECT_EQ(loop.ToRecord().At("u").samples[4], 0.25);
}

TEST(TickLoop, ReadsInStepsOfTheResolution) {
  OpenLoop bench(3);
  bench.setup.channels.sensors[0].resolution = 1e-3;
  TickLoop loop(bench.setup, bench.ramp, {});
  for (const double q : {0.0104, 0.0106, -0.0106}) Tick(loop, q);
  EXPECT_THAT(loop.ToRecord().At("q").samples,
              testing::ElementsAre(testing::DoubleEq(0.010), testing::DoubleEq(0.011),
                                   testing::DoubleEq(-0.011)));
}

Eigen::VectorXd ReadingsOf(double noise_scale, std::uint64_t seed) {
  constexpr Index kTicks = 4000;
  OpenLoop bench(kTicks);
  bench.setup.channels.sensors[0].noise_sd = 2e-6;
  RunOptions options;
  options.noise_scale = noise_scale;
  options.seed = seed;
  TickLoop loop(bench.setup, bench.ramp, options);
  for (Index k = 0; k < kTicks; ++k) Tick(loop, 0.5);
  return loop.ToRecord().At("q").samples.array() - 0.5;
}

TEST(TickLoop, AddsTheNoiseOfTheSeedToReadings) {
  const Eigen::VectorXd noise = ReadingsOf(3.0, 7);
  EXPECT_EQ(noise, ReadingsOf(3.0, 7));
  EXPECT_NE(noise, ReadingsOf(3.0, 8));
  EXPECT_EQ(ReadingsOf(0.0, 7).norm(), 0.0);
  // The standard deviation of 4000 samples is known to 1.1 %; four times that.
  EXPECT_NEAR(std::sqrt(noise.squaredNorm() / 4000.0), 6e-6, 0.045 * 6e-6);
}

/// The bonder on its way along x, while its encoders stand still.
struct ClosedLoop {
  explicit ClosedLoop(const RunOptions& options = {})
      : motion(FollowTrajectory(setup, setup.trajectories.Find("x"))),
        loop(setup, motion, options) {}
  void Tick() { loop.Tick(outputs, inputs); }

  mjdiag::Setup setup = Bonder();
  Excitation motion;
  TickLoop loop;
  std::array<double, 3> outputs{};
  std::array<double, 3> inputs{};
};

RunOptions Quiet() {
  RunOptions options;
  options.noise_scale = 0.0;
  return options;
}

// Eq. 7 on every actuator: the plant gets it, and the record, which shows what was
// commanded, does not.
TEST(TickLoop, AddsDisturbancesToThePlantAndNotToTheRecord) {
  RunOptions options = Quiet();
  options.disturbances["gamma"] = 0.5;
  ClosedLoop bench(options);
  const MultisineSetup& gamma = bench.setup.disturbances[0];
  const double amplitude = gamma.amplitude.at("u_x");
  ASSERT_GT(amplitude, 0.0);
  for (int k = 0; k < 300; ++k) {
    bench.Tick();
    double expected = 0.0;
    for (const double frequency : gamma.frequencies) {
      expected +=
          0.5 * amplitude *
          std::sin(2.0 * std::numbers::pi * frequency * k * bench.setup.rates.tick());
    }
    const double commanded = bench.loop.ToRecord().At("u_x").samples[k];
    EXPECT_NEAR(bench.inputs[0] - commanded, expected, 1e-9) << k;
  }
}

TEST(TickLoop, LogsReadingsAndReferencesOfEveryAxis) {
  ClosedLoop bench(Quiet());
  for (int k = 0; k < 200; ++k) {
    bench.outputs = {1e-6 * k, -1e-6, 2e-6};
    bench.Tick();
  }
  const Record record = bench.loop.ToRecord();
  EXPECT_EQ(record.samples(), 200);
  EXPECT_DOUBLE_EQ(record.At("x").samples[100], 1e-4);
  EXPECT_DOUBLE_EQ(record.At("z").samples[100], 2e-6);
  const AxisReference& x = bench.motion.reference.axes[0];
  EXPECT_EQ(record.At("x_ref").samples, x.position.head(200));
  EXPECT_EQ(record.At("x_ref_snap").samples, x.snap.head(200));
  EXPECT_EQ(record.At("x_ref_snap").unit, "m/s^4");
  EXPECT_EQ(record.At("z_ref_velocity").unit, "rad/s");
}

TEST(TickLoop, ShowsItsObserverTheReadingsAndCommandsOfTheRecord) {
  struct Recorder : TickObserver {
    void OnTick(std::span<const double> outputs,
                std::span<const double> inputs) noexcept override {
      x = outputs[0];
      u_x = inputs[0];
      ++ticks;
    }
    double x = 0.0;
    double u_x = 0.0;
    int ticks = 0;
  } recorder;
  RunOptions options;
  options.observer = &recorder;
  options.disturbances["gamma"] = 0.5;
  ClosedLoop bench(options);
  for (int k = 0; k < 100; ++k) {
    bench.Tick();
    const Record record = bench.loop.ToRecord();
    EXPECT_EQ(recorder.x, record.At("x").samples[k]);
    EXPECT_EQ(recorder.u_x, record.At("u_x").samples[k]);
  }
  EXPECT_EQ(recorder.ticks, 100);
  EXPECT_NE(recorder.x, 0.0) << "without the sensors' noise";
}

TEST(TickLoop, DoesNotAllocate) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  RunOptions options;
  options.disturbances["gamma"] = 0.1;
  ClosedLoop bench(options);
  EXPECT_EQ(test::CountAllocations([&] {
              for (int k = 0; k < 100; ++k) bench.Tick();
            }),
            0);
  EXPECT_GT(test::CountAllocations([&] { bench.loop.ToRecord(); }), 0)
      << "the counter does not count";
}

TEST(TickLoop, NamesWhatTheExcitationOrTheSetupLacks) {
  const auto refusal = [](const mjdiag::Setup& setup, const Excitation& excitation,
                          const RunOptions& options) {
    return test::MessageOf<InputError>([&] { TickLoop(setup, excitation, options); });
  };
  const mjdiag::Setup setup = Bonder();
  const Excitation motion = FollowTrajectory(setup, setup.trajectories.Find("x"));
  Excitation swapped = motion;
  std::swap(swapped.reference.axes[0], swapped.reference.axes[1]);
  EXPECT_THAT(refusal(setup, swapped, {}), HasSubstr("no motion for axis 'x'"));
  RunOptions options;
  options.disturbances["delta"] = 1.0;
  EXPECT_THAT(refusal(setup, motion, options), HasSubstr("'delta'"));
  OpenLoop open(5);
  open.ramp.inputs = Record(open.setup.rates.tick());
  EXPECT_THAT(refusal(open.setup, open.ramp, {}), HasSubstr("u"));
}

}  // namespace
}  // namespace mjdiag
