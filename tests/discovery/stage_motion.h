#pragma once
// The motion of the stage of support/stage.h as a filter has it.

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "support/stage.h"

namespace mjdiag::test {

inline ObservedMotion MotionOf(const Stage& stage) {
  const MeasuredRun run = ToMeasuredRun(stage.setup(), stage.Measure({}));
  const FilterPath path =
      FilterLikeliest(stage.machine, run, SensorNoise(stage.machine.channels(), run));
  return MotionAlong(stage.machine, run, path);
}

}  // namespace mjdiag::test
