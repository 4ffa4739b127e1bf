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
    EXPECT_NEAR(said.misfit, 1.0, 0.3) << from;
  }
}

TEST(RunPass, KnowsLessWhereTheStartIsUnknown) {
  const test::StageRun run = test::RunStage({0.02, -0.03, -0.01}, 0.0, 5, kTicks);
  const MatrixXd whole = CovarianceOf(Learn(0, run).second.H);
  const MatrixXd end = CovarianceOf(Learn(800, run).second.H);
  for (Index i = 0; i < 3; ++i) EXPECT_GT(end(i, i), whole(i, i));
}

}  // namespace
}  // namespace mjdiag
