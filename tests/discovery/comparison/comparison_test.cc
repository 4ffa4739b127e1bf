#include "mjdiag/discovery/comparison/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mjdiag/signals/error.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

Machine Emps() {
  return Machine(ReadSetup(std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf/emps",
                           {"sensors.q.noise_sd=2e-8"}));
}

Record Measurement(const Machine& machine, const RunOptions& options = {}) {
  const Trajectories& motions = machine.setup().trajectories;
  return Simulate(machine,
                  FollowTrajectory(machine.setup(), motions.Find(motions.fallback)),
                  options);
}

Comparison CompareToNominal(const Machine& machine, const Record& measured) {
  RunOptions options;
  options.seed = 12345;
  return Compare(machine, measured, options);
}

// 20 runs of 2 channels at a level of 1 %: more than 3 false alarms have a chance of
// 7e-4.
TEST(Comparison, OfTheSameMachineRarelyExceedsTheNoise) {
  const Machine machine = Emps();
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RunOptions options;
    options.seed = seed;
    const Comparison result = CompareToNominal(machine, Measurement(machine, options));
    ASSERT_EQ(result.channels.size(), 2U);
    for (const ChannelMismatch& channel : result.channels) {
      alarms += channel.exceeds_noise;
      EXPECT_NEAR(channel.rms, channel.noise_floor.rms, 0.2 * channel.rms);
    }
  }
  EXPECT_LE(alarms, 3);
}

TEST(Comparison, SeesDryFriction) {
  const Machine machine = Emps();
  const Machine rubbing =
      machine.With(test::With({"coulomb_friction@load:force=20.4"}));
  const Comparison result = CompareToNominal(machine, Measurement(rubbing));
  EXPECT_TRUE(result.exceeds_noise());
  ASSERT_NE(result.Worst(), nullptr);
  EXPECT_GT(result.Worst()->rms, 50.0 * result.Worst()->noise_floor.rms);
  EXPECT_TRUE(result.closed_loop);
}

TEST(Comparison, NamesDerivedSignals) {
  const Machine machine = Emps();
  const Comparison result = CompareToNominal(machine, Measurement(machine));
  std::vector<std::string> names;
  for (const DerivedMismatch& derived : result.derived) names.push_back(derived.name);
  EXPECT_THAT(names, ElementsAre("q_velocity", "q_acceleration", "force"));
}

TEST(Comparison, GoesOnWithoutAChannelThatWasNotMeasured) {
  const Machine machine = Emps();
  const Record full = Measurement(machine);
  Record measured(full.sample_time());
  measured.Add(full.At("q"));
  measured.Add(full.At("q_ref"));
  const Comparison result = CompareToNominal(machine, measured);
  EXPECT_EQ(result.channels.size(), 1U);
  EXPECT_THAT(result.not_measured, ElementsAre("u"));
}

TEST(Comparison, RefusesARecordThatIsTooShort) {
  const Machine machine = Emps();
  const Record measured = Measurement(machine).Slice(0, 60);
  EXPECT_THAT([&] { CompareToNominal(machine, measured); },
              ThrowsMessage<InputError>(HasSubstr("at least 64")));
}

TEST(Comparison, RefusesAChannelInAnotherUnit) {
  const Machine machine = Emps();
  const Record full = Measurement(machine);
  Record measured(full.sample_time());
  for (Channel channel : full.channels()) {
    if (channel.name == "u") channel.unit = "A";
    measured.Add(channel);
  }
  EXPECT_THAT([&] { CompareToNominal(machine, measured); },
              ThrowsMessage<InputError>(HasSubstr("in 'A'; expected V")));
}

}  // namespace
}  // namespace mjdiag
