#include "mjdiag/discovery/answer/posterior.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mjdiag {
namespace {

ModelMove ExchangeFor(std::size_t block, double worse) {
  ModelMove move{{0}, {}, worse, 0, false};
  Variation variation;
  variation.block = block;
  variation.values = [](const Amplitudes& a) -> RegressorValues {
    return Eigen::VectorXd(a);
  };
  move.added.push_back({variation, Eigen::VectorXd::Ones(1)});
  return move;
}

/// One member, of block 0, and what a search found in its place.
Explained ExplainedWith(std::vector<ModelMove> rivals) {
  Explained explained;
  explained.fit.model = {{0, Eigen::VectorXd::Ones(1)}};
  explained.rivals = std::move(rivals);
  return explained;
}

UnseenJudgement JudgedWith(const MemberLoss& loss) {
  UnseenJudgement judged;
  judged.places = {0};
  judged.losses = {loss};
  judged.exchanges = {{}};
  judged.answer.fit.model = {{0, Eigen::VectorXd::Ones(1)}};
  return judged;
}

double SumOf(const MemberPosterior& one) {
  double sum = one.probability + one.none;
  for (const Rival& rival : one.rivals) sum += rival.probability;
  return sum;
}

TEST(Posterior, SharesOneProbabilityAmongAllThatCouldBeInAPlace) {
  const auto posterior =
      PosteriorOf(ExplainedWith({ExchangeFor(1, 2.0), ExchangeFor(2, 6.0)}),
                  JudgedWith({5.0, 3.0}));
  ASSERT_EQ(posterior.size(), 1u);
  const MemberPosterior& one = posterior.front();
  EXPECT_NEAR(SumOf(one), 1.0, 1e-12);
  EXPECT_NEAR(one.none / one.probability, std::exp(-4.0), 1e-12);
  ASSERT_EQ(one.rivals.size(), 2u);
  EXPECT_EQ(one.rivals[0].block, 1u);
  EXPECT_NEAR(one.rivals[0].probability / one.probability, std::exp(-1.0), 1e-12);
}

TEST(Posterior, CountsABlockOnceByTheBestOfItsShapes) {
  const auto posterior =
      PosteriorOf(ExplainedWith({ExchangeFor(1, 8.0), ExchangeFor(1, 2.0)}),
                  JudgedWith({100.0, 50.0}));
  ASSERT_EQ(posterior.front().rivals.size(), 1u);
  EXPECT_NEAR(posterior.front().rivals[0].probability / posterior.front().probability,
              std::exp(-1.0), 1e-12);
}

TEST(Posterior, IsSureOfWhatNothingStandsFor) {
  const auto posterior = PosteriorOf(ExplainedWith({}), JudgedWith({1000.0, 400.0}));
  EXPECT_DOUBLE_EQ(posterior.front().probability, 1.0);
}

TEST(Posterior, BelievesAFitRatherThanFirstOrder) {
  UnseenJudgement judged = JudgedWith({1000.0, 400.0});
  judged.exchanges = {{{1, Eigen::VectorXd::Ones(1), {30.0, 10.0}}}};
  const auto posterior = PosteriorOf(ExplainedWith({ExchangeFor(1, 2.0)}), judged);
  EXPECT_GT(posterior.front().probability, 0.999);
}

// Another shape of the same law is no other law.
TEST(Posterior, HasNoRivalInTheMemberItself) {
  const auto posterior =
      PosteriorOf(ExplainedWith({ExchangeFor(0, 0.0)}), JudgedWith({1000.0, 400.0}));
  EXPECT_TRUE(posterior.front().rivals.empty());
}

}  // namespace
}  // namespace mjdiag
