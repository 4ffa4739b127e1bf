#include "mjdiag/discovery/comparison/observed_joints.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

// Friction of 20 N, of which the plant at hand knows nothing, moves the stage by more
// than ten micrometres off what that plant would do.
TEST(ObservedJoints, FollowTheEncoderWhateverTheModelLacks) {
  const test::Stage stage;
  const Record measured = stage.Measure({"coulomb_friction@load:force=20"});
  const Record seen = WithObservedJoints(stage.machine, measured);
  const Channel& joint = seen.At("joint.load");
  EXPECT_EQ(joint.unit, "m");
  ASSERT_EQ(joint.samples.size(), measured.samples());
  EXPECT_LT((joint.samples - measured.At("q").samples).cwiseAbs().maxCoeff(), 5e-6);
  EXPECT_EQ(seen.channels().size(), measured.channels().size() + 1);
}

TEST(ObservedJoints, ARecordWithoutTheInputIsRefused) {
  const test::Stage stage;
  const Record measured = stage.Measure({});
  Record cut(measured.sample_time());
  cut.Add(measured.At("q"));
  EXPECT_THROW(WithObservedJoints(stage.machine, cut), InputError);
}

}  // namespace
}  // namespace mjdiag
