#include "mjdiag/plugin/extension/setup_following.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Trajectory Wobble(const Setup& setup) {
  Trajectory trajectory = setup.trajectories.Find("x");
  trajectory.name = "wobble";
  trajectory.ramp = 0.05;
  trajectory.tones = {{"x", 123.456789, 1.0 / 3e6, -0.7}, {"z", 50.0, 1e-4, 0.0}};
  return trajectory;
}

TEST(SetupFollowing, FollowsThatTrajectoryToTheBit) {
  const test::TemporaryFolder folder;
  const auto nominal = std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf/ab383";
  const auto before = ReadSetup(nominal);
  const Trajectory wobble = Wobble(before);
  WriteSetupFollowing(folder.path() / "out", nominal, wobble);
  const auto after = ReadSetup(folder.path() / "out");
  EXPECT_EQ(after.trajectories.fallback, "wobble");
  EXPECT_EQ(after.trajectories.all.size(), before.trajectories.all.size() + 1);
  const Reference given = FollowTrajectory(before, wobble).reference;
  const Reference read = DefaultMotion(after).reference;
  for (std::size_t i = 0; i < given.axes.size(); ++i) {
    EXPECT_EQ(read.axes[i].position, given.axes[i].position);
    EXPECT_EQ(read.axes[i].snap, given.axes[i].snap);
  }
}

TEST(SetupFollowing, RefusesANameThatThereIs) {
  const auto nominal = std::filesystem::path(MJDIAG_SOURCE_DIR) / "mjcf/ab383";
  Trajectory same = Wobble(ReadSetup(nominal));
  same.name = "xyz";
  EXPECT_THAT([&] { SetupFollowing(nominal, same); },
              ThrowsMessage<InputError>(HasSubstr("has a trajectory 'xyz' already")));
}

}  // namespace
}  // namespace mjdiag
