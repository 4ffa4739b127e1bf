#include "mjdiag/discovery/selection/model_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd White(Index n, double sd) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(0.0, sd);
  return VectorXd::NullaryExpr(n, [&] { return normal(generator); });
}

TEST(Deviance, OfWhatIsNoiseIsItsSumOfSquares) {
  VectorXd e = White(1000, 0.5);
  const VectorXd all = VectorXd::Ones(1);
  EXPECT_NEAR(Deviance(e, all, 0, 1000), e.squaredNorm(), 1e-9);
  // Above the noise the scale is the residual's own: n (log s^2 + 1).
  e *= 8.0;
  EXPECT_NEAR(Deviance(e, all, 0, 1000),
              1000.0 * (std::log(e.squaredNorm() / 1000.0) + 1.0), 1e-9);
}

TEST(Deviance, CountsIndependentValuesOnly) {
  const VectorXd e = White(1000, 3.0);
  EXPECT_NEAR(Deviance(e, VectorXd::Constant(1, 0.25), 0, 1000),
              0.25 * Deviance(e, VectorXd::Ones(1), 0, 1000), 1e-9);
}

// Quantiles of chi-squared from tables.
TEST(GainByChance, IsTheQuantileOfChiSquared) {
  EXPECT_NEAR(GainByChance(1e-4, 1, 2), 18.4207, 1e-4);
  EXPECT_NEAR(GainByChance(1e-4, 1, 1), 15.1367, 1e-4);
  EXPECT_NEAR(GainByChance(1e-4, 1, 3), 21.1075, 1e-4);
  // The best of a hundred.
  EXPECT_NEAR(GainByChance(1e-4, 100, 2), GainByChance(1e-6, 1, 2), 1e-9);
}

// 14,000 samples of a first-order low-pass with 20 samples of memory hold about one
// independent value in 40.
TEST(IndependentShare, IsOneOfWhiteNoiseAndSmallOfSlowNoise) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure({}));
  VectorXd e = White(problem.run().samples(), 1.0);
  EXPECT_GT(IndependentShare(problem, e)[0], 0.9);
  for (Index k = 1; k < e.size(); ++k) e[k] += 0.95 * e[k - 1];
  EXPECT_LT(IndependentShare(problem, e)[0], 0.1);
}

}  // namespace
}  // namespace mjdiag
