#include "mjdiag/diagnosis/twin/run_pass.h"

#include <gtest/gtest.h>

#include "diagnosis/twin/uncertain_stage.h"
#include "mjdiag/diagnosis/twin/linear_twin.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kTicks = 3200;
/// Of the stage: three factors and two parts of a tone.
constexpr Index kNumbers = 5;

/// What is said of the numbers after a few passes, by all of a run or by its end.
std::pair<VectorXd, RunInformation> Learn(Index from, const test::StageRun& run) {
  const UncertainModel model = test::UncertainStage();
  const MatrixXd noise = test::kNoise * test::kNoise * MatrixXd::Identity(2, 2);
  RunPass pass(
      std::make_unique<LinearTwin>(
          model, std::vector<TwinGain>{{MatrixXd::Zero(6, 2), noise, 0}}, test::kBlock),
      run.outputs.rightCols(kTicks - from), run.inputs.rightCols(kTicks - from),
      PriorOf(model.unknowns));
  EXPECT_EQ(pass.at_rest(), from == 0);
  VectorXd theta = VectorXd::Zero(kNumbers);
  RunInformation said;
  for (int i = 0; i < 6; ++i) {
    said = pass.About(theta, 0);
    theta += CovarianceOf(said.H) * said.g;
  }
  return {theta, said};
}

TEST(RunPass, FindsTheNumbersOfARunFromRestAndInMidMotion) {
  const Eigen::Vector3d deviations(0.02, -0.03, -0.01);
  const test::StageRun run = test::RunStage(deviations, 0.0, 5, kTicks);
  for (const Index from : {Index{0}, Index{800}}) {
    const auto [theta, said] = Learn(from, run);
    const VectorXd sd = CovarianceOf(said.H).diagonal().cwiseSqrt();
    for (Index i = 0; i < 3; ++i) {
      // Three numbers twice within 4.5 standard deviations: by chance not with 4e-5.
      EXPECT_LT(std::abs(theta[i] - std::log1p(deviations[i])), 4.5 * sd[i])
          << from << i;
    }
    // A mean of 2 * 400 squares at most, of standard deviation 0.05 to 0.06.
    EXPECT_NEAR(said.nis, 1.0, 0.3) << from;
  }
}

/// Of a stage that is held in its place: with the noise of its encoder the controller of
/// its motor moves it, and nothing else does.
test::StageRun Held(std::uint64_t seed) {
  constexpr double kStiffness = 6.0 * 190.0 * 190.0;  // 30 Hz [N/m]
  constexpr double kDamping = 6.0 * 1.4 * 190.0;      // [N s/m]
  const StateSpace plant =
      TickModel(test::Stage(), test::kTiming.step, test::kTiming.substeps);
  const VectorXd rest = test::UncertainStage().rest;
  test::StageRun run;
  run.inputs = MatrixXd::Zero(2, kTicks);
  run.outputs = test::WhiteNoise(2, kTicks, test::kNoise, seed);
  VectorXd x = VectorXd::Zero(plant.A.rows());
  double before = 0.0;
  for (Index k = 0; k < kTicks; ++k) {
    run.outputs.col(k) += plant.C * x;
    const double y = run.outputs(0, k);
    run.inputs(0, k) = -kStiffness * y - kDamping * (y - before) / test::kTiming.tick();
    before = y;
    x = plant.A * x + plant.B * run.inputs.col(k);
  }
  run.outputs.colwise() += rest;
  return run;
}

// g^T H^-1 g at the truth is chi-squared with 5 degrees of freedom: the mean of 200 is
// within 4 sqrt(10 / 200) = 0.9 of 5.
TEST(RunPass, IsAsSureAsItSaysWhereNoiseMovesTheMachine) {
  const UncertainModel model = test::UncertainStage();
  const MatrixXd noise = test::kNoise * test::kNoise * MatrixXd::Identity(2, 2);
  constexpr int kRuns = 200;
  double sum = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    const test::StageRun run = Held(static_cast<std::uint64_t>(i) + 1);
    RunPass pass(std::make_unique<LinearTwin>(
                     model, std::vector<TwinGain>{{MatrixXd::Zero(6, 2), noise, 0}},
                     test::kBlock),
                 run.outputs, run.inputs, PriorOf(model.unknowns));
    const RunInformation said = pass.About(VectorXd::Zero(kNumbers), 0);
    sum += said.g.dot(CovarianceOf(said.H) * said.g) / kRuns;
  }
  EXPECT_NEAR(sum, 5.0, 0.9);
}

TEST(RunPass, KnowsLessWhereTheStartIsUnknown) {
  const test::StageRun run = test::RunStage({0.02, -0.03, -0.01}, 0.0, 5, kTicks);
  const MatrixXd whole = CovarianceOf(Learn(0, run).second.H);
  const MatrixXd end = CovarianceOf(Learn(800, run).second.H);
  for (Index i = 0; i < 3; ++i) EXPECT_GT(end(i, i), whole(i, i));
}

}  // namespace
}  // namespace mjdiag
