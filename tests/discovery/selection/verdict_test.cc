#include "mjdiag/discovery/selection/verdict.h"

#include <gtest/gtest.h>

namespace mjdiag {
namespace {

/// A search that left so much, times the power of sensor noise.
SearchResult Left(double train, bool significant_rest) {
  CauseFit fit;
  fit.train = train;
  SearchResult search;
  search.evidence = {{}, fit, Eigen::VectorXd::Ones(1)};
  search.significant_rest = significant_rest;
  return search;
}

TEST(Verdict, IsNoDiscrepancyWhereNothingWasFound) {
  EXPECT_EQ(VerdictOf(Left(1.0, false), false, 1.0, true),
            DiscoveryVerdict::kNoDiscrepancy);
}

TEST(Verdict, IsUnexplainedWhereSomethingIsThereAndNothingIsNamed) {
  EXPECT_EQ(VerdictOf(Left(3.0, true), false, 3.0, true),
            DiscoveryVerdict::kUnexplained);
  SearchResult dropped = Left(3.0, false);
  dropped.ladder.emplace_back();
  EXPECT_EQ(VerdictOf(dropped, false, 3.0, true), DiscoveryVerdict::kUnexplained);
}

TEST(Verdict, IsNoDiscrepancyWhereWhatWasFoundIsNothingBesideNumbersOfThePlant) {
  CauseFit fit = Left(1.0, false).fit();
  fit.numbers = Eigen::VectorXd::Zero(1);
  SearchResult dropped;
  dropped.evidence = {{}, fit, Eigen::VectorXd::Ones(1)};
  dropped.ladder.emplace_back();
  EXPECT_EQ(VerdictOf(dropped, false, 3.0, true), DiscoveryVerdict::kNoDiscrepancy);
}

TEST(Verdict, IsUnexplainedWhereNumbersOfThePlantLeaveMoreThanNoise) {
  const auto beside = [](double left) {
    CauseFit fit = Left(left, false).fit();
    fit.numbers = Eigen::VectorXd::Zero(1);
    SearchResult result;
    result.evidence = {{}, fit, Eigen::VectorXd::Ones(1)};
    return VerdictOf(result, false, 50.0, true);
  };
  EXPECT_EQ(beside(3.9), DiscoveryVerdict::kNoDiscrepancy);
  EXPECT_EQ(beside(4.1), DiscoveryVerdict::kUnexplained);
}

TEST(Verdict, IsExplainedWhereCausesLeaveNoise) {
  EXPECT_EQ(VerdictOf(Left(1.1, false), true, 50.0, true),
            DiscoveryVerdict::kExplained);
}

TEST(Verdict, IsPartlyExplainedWhereCausesTakeMostOfIt) {
  EXPECT_EQ(VerdictOf(Left(1.1, true), true, 50.0, true),
            DiscoveryVerdict::kPartlyExplained);
  EXPECT_EQ(VerdictOf(Left(1.1, false), true, 50.0, false),
            DiscoveryVerdict::kPartlyExplained);
  EXPECT_EQ(VerdictOf(Left(4.1, false), true, 50.0, true),
            DiscoveryVerdict::kPartlyExplained);
}

TEST(Verdict, IsUnexplainedWhereCausesLeaveTheGreaterPart) {
  EXPECT_EQ(VerdictOf(Left(25.0, true), true, 50.0, true),
            DiscoveryVerdict::kPartlyExplained);
  EXPECT_EQ(VerdictOf(Left(26.0, true), true, 50.0, true),
            DiscoveryVerdict::kUnexplained);
}

}  // namespace
}  // namespace mjdiag
