#include "mjdiag/discovery/fit/input_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;

/// A slow command, and one with noise.
MeasuredRun TwoInputs() {
  constexpr Index kSamples = 4000;
  MeasuredRun run;
  run.sample_time = 1e-3;
  run.outputs = Eigen::MatrixXd::Zero(1, kSamples);
  run.inputs.resize(2, kSamples);
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  for (Index k = 0; k < kSamples; ++k) {
    const double command = std::sin(0.05 * static_cast<double>(k));
    run.inputs.col(k) << command, command + 0.1 * normal(generator);
  }
  return run;
}

// What a window takes off a command without noise is a part of the command.
TEST(InputChoice, SmoothsWhatHasNoiseOnly) {
  const MeasuredRun run = TwoInputs();
  // In a window of 4 ticks the command loses a hundredth, its noise nine tenths.
  const MeasuredRun smooth = WithInputsOver(run, 4.0);
  EXPECT_EQ(smooth.inputs.row(0), run.inputs.row(0));
  EXPECT_LT((smooth.inputs.row(1) - run.inputs.row(0)).norm(),
            0.5 * (run.inputs.row(1) - run.inputs.row(0)).norm());
}

}  // namespace
}  // namespace mjdiag
