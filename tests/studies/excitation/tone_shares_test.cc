#include "mjdiag/studies/excitation/tone_shares.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

ToneChoice Choice(std::size_t axis, const MatrixXd& information) {
  return {axis, 1.0, 1.0, information};
}

MatrixXd Of(double first, double second) {
  return Vector2d(first, second).asDiagonal();
}

const MatrixXd kLittle = 1e-6 * MatrixXd::Identity(2, 2);

TEST(ShareTones, GivesAllToTheOneThatTellsMostOfWhatIsWanted) {
  const std::vector<ToneChoice> choices = {Choice(0, Of(4.0, 1.0)),
                                           Choice(0, Of(9.0, 0.1))};
  const ToneShares first = ShareTones(choices, kLittle, VectorXd::Ones(1), {0}, {});
  EXPECT_EQ(first.shares, Vector2d(0.0, 1.0));
  EXPECT_NEAR(first.log_sd, -std::log(3.0), 1e-6);
  const ToneShares second = ShareTones(choices, kLittle, VectorXd::Ones(1), {1}, {});
  EXPECT_EQ(second.shares, Vector2d(1.0, 0.0));
}

// Each tells one alone: with s and 1 - s the larger of 1 / s and 1 / (1 - s) is least at
// a half, and 4 is what both standard deviations then are, of information 1 / 4.
TEST(ShareTones, SharesWhereOneToneDoesNotTellAll) {
  const std::vector<ToneChoice> choices = {Choice(0, Of(0.25, 0.0)),
                                           Choice(0, Of(0.0, 0.25))};
  const ToneShares both = ShareTones(choices, kLittle, VectorXd::Ones(1), {0, 1}, {});
  EXPECT_NEAR(both.shares[0], 0.5, 0.05);
  EXPECT_NEAR(both.shares.sum(), 1.0, 1e-12);
  EXPECT_NEAR(both.log_sd, std::log(4.0), 0.1);
}

TEST(ShareTones, KeepsToTheBudgetOfEveryAxis) {
  const std::vector<ToneChoice> choices = {
      Choice(0, Of(100.0, 0.0)), Choice(1, Of(0.0, 1.0)), Choice(1, Of(0.0, 2.0))};
  const ToneShares shares =
      ShareTones(choices, kLittle, Vector2d(0.3, 0.7), {0, 1}, {});
  EXPECT_NEAR(shares.shares[0], 0.3, 1e-12);
  EXPECT_NEAR(shares.shares[1] + shares.shares[2], 0.7, 1e-12);
  EXPECT_NEAR(shares.shares[2], 0.7, 1e-12);
}

TEST(LargestLogSd, IsInfiniteWhereNothingTells) {
  EXPECT_EQ(LargestLogSd(Of(1.0, 0.0), {0}), std::numeric_limits<double>::infinity());
  Matrix2d correlated;
  correlated << 1.0, 0.6, 0.6, 1.0;
  EXPECT_NEAR(LargestLogSd(correlated, {0}), -0.5 * std::log(0.64), 1e-12);
}

}  // namespace
}  // namespace mjdiag
