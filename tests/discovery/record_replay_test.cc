// Free simulation beside records, in the physics steps that they know.

#include "mjdiag/discovery/record_replay.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/runtime/simulation.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

/// Rms of the encoder over its noise floor, of a record in much finer steps than the plant has.
double OverNoise(PhysicsSteps steps) {
  const test::Stage stage;
  const Record fine =
      Simulate(stage.machine.WithSubsteps(32), stage.Motion(), RunOptions{});
  const RecordReplay replay =
      ReplayAll(MeasurementsOf(stage.machine, fine, nullptr), {}, steps, 1, false, {})
          .front();
  const ChannelMismatch& encoder = replay.before.channels.front();
  EXPECT_EQ(encoder.rms, replay.after.channels.front().rms);
  return encoder.rms / encoder.noise_floor.rms;
}

// Both are noise, the record's and none, so that a rms of 1 is all there is; of 25,000 samples
// it is known to some hundredths.
TEST(RecordReplay, OfAMachineInStepsThatTheRecordKnowsIsOffByNoiseAlone) {
  EXPECT_GT(OverNoise({}), 5.0);
  EXPECT_LT(OverNoise({15.0 / 16.0}), 1.2);
}

}  // namespace
}  // namespace mjdiag
