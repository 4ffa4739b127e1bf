#include "mjdiag/comparison/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

Setup Emps() {
  return ReadSetup(std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf/emps",
                   {"sensors.q.noise_sd=2e-8"});
}

Record Measurement(const Setup& setup, const RunOptions& options) {
  const ModelPtr plant = LoadPlant(setup);
  const Trajectory& trajectory = setup.trajectories.Find(setup.trajectories.fallback);
  return Simulate(setup, *plant, FollowTrajectory(setup, trajectory), options);
}

Comparison CompareToNominal(const Setup& setup, const Record& measured) {
  RunOptions options;
  options.seed = 12345;
  return Compare(setup, *LoadPlant(setup), measured, options);
}

// 20 runs of 2 channels at a level of 1 %: more than 3 false alarms have a chance of
// 7e-4.
TEST(Comparison, OfTheSameMachineRarelyExceedsTheNoise) {
  const mjdiag::Setup setup = Emps();
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RunOptions options;
    options.seed = seed;
    const Comparison result = CompareToNominal(setup, Measurement(setup, options));
    ASSERT_EQ(result.channels.size(), 2U);
    for (const ChannelMismatch& channel : result.channels) {
      alarms += channel.exceeds_noise;
      EXPECT_NEAR(channel.rms, channel.noise_floor.rms, 0.2 * channel.rms);
    }
  }
  EXPECT_LE(alarms, 3);
}

TEST(Comparison, SeesDryFriction) {
  const mjdiag::Setup setup = Emps();
  RunOptions options;
  options.effects = {ParseEffect("coulomb_friction@load:force=20.4")};
  const Comparison result = CompareToNominal(setup, Measurement(setup, options));
  EXPECT_TRUE(result.exceeds_noise());
  ASSERT_NE(result.Worst(), nullptr);
  EXPECT_GT(result.Worst()->rms, 50.0 * result.Worst()->noise_floor.rms);
  EXPECT_TRUE(result.closed_loop);
}

TEST(Comparison, NamesDerivedSignals) {
  const mjdiag::Setup setup = Emps();
  const Comparison result = CompareToNominal(setup, Measurement(setup, {}));
  std::vector<std::string> names;
  for (const DerivedMismatch& derived : result.derived) names.push_back(derived.name);
  EXPECT_THAT(names, ElementsAre("q_velocity", "q_acceleration", "force"));
}

TEST(Comparison, GoesOnWithoutAChannelThatWasNotMeasured) {
  const mjdiag::Setup setup = Emps();
  const Record full = Measurement(setup, {});
  Record measured(full.sample_time());
  measured.Add(full.At("q"));
  measured.Add(full.At("q_ref"));
  const Comparison result = CompareToNominal(setup, measured);
  EXPECT_EQ(result.channels.size(), 1U);
  EXPECT_THAT(result.not_measured, ElementsAre("u"));
}

TEST(Comparison, RefusesARecordThatIsTooShort) {
  const mjdiag::Setup setup = Emps();
  const Record measured = Measurement(setup, {}).Slice(0, 60);
  EXPECT_THAT([&] { CompareToNominal(setup, measured); },
              ThrowsMessage<InputError>(HasSubstr("at least 64")));
}

TEST(Comparison, RefusesAChannelInAnotherUnit) {
  const mjdiag::Setup setup = Emps();
  const Record full = Measurement(setup, {});
  Record measured(full.sample_time());
  for (Channel channel : full.channels()) {
    if (channel.name == "u") channel.unit = "A";
    measured.Add(channel);
  }
  EXPECT_THAT([&] { CompareToNominal(setup, measured); },
              ThrowsMessage<InputError>(HasSubstr("unit V as in the setup")));
}

}  // namespace
}  // namespace mjdiag
