#include "mjdiag/diagnosis/twin/naming.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::ElementsAre;

const std::vector<std::vector<Index>> kSingles{{0}, {1}, {2}};

/// Unit variances, the first two unknowns alike.
MatrixXd Covariance(double correlation) {
  MatrixXd covariance = MatrixXd::Identity(3, 3);
  covariance(0, 1) = covariance(1, 0) = correlation;
  return covariance;
}

TEST(NameFaults, NamesAFaultThatItsOwnIntervalDoesNotShow) {
  // One standard deviation from healthy by itself, thirty if the other is healthy.
  const VectorXd deviations = (VectorXd(3) << 1.0, 0.0, 0.5).finished();
  EXPECT_THAT(NameFaults(deviations, Covariance(0.9995), kSingles, 1e-4),
              ElementsAre(true, false, false));
}

TEST(NameFaults, NamesBothWhereOneDoesNotExplainTheOther) {
  const VectorXd deviations = (VectorXd(3) << 9.0, -9.0, 0.0).finished();
  EXPECT_THAT(NameFaults(deviations, Covariance(0.9), kSingles, 1e-4),
              ElementsAre(true, true, false));
}

TEST(NameFaults, NamesOneFaultInsteadOfTwoThatTogetherDoTheSame) {
  // The first does what the others do together but for one part in a hundred, and noise
  // has turned it into them.
  const MatrixXd does = (MatrixXd(3, 3) << 1.0, 1.0, 0.0,  //
                         1.0, 0.0, 1.0,                    //
                         0.01, 0.0, 0.0)
                            .finished();
  const MatrixXd covariance = 0.01 * (does.transpose() * does).inverse();
  const VectorXd deviations = (VectorXd(3) << 0.1, 4.9, 4.9).finished();
  EXPECT_THAT(NameFaults(deviations, covariance, kSingles, 1e-4),
              ElementsAre(true, false, false));
}

TEST(NameFaults, JudgesTheTonesOfADisturbanceTogether) {
  // Each within 3.3 standard deviations: none by itself, both together.
  const VectorXd deviations = (VectorXd(3) << 3.3, -3.3, 0.0).finished();
  EXPECT_THAT(NameFaults(deviations, Covariance(0.0), kSingles, 1e-3),
              ElementsAre(false, false, false));
  EXPECT_THAT(NameFaults(deviations, Covariance(0.0), {{0, 1}, {2}}, 1e-3),
              ElementsAre(true, false));
}

// The prices are exact for one group and cautious for several.
TEST(NameFaults, IsWrongAboutHealthyMachinesAsOftenAsAllowed) {
  constexpr int kRuns = 4000;
  constexpr double kAllowed = 0.05;
  const MatrixXd covariance = Covariance(0.8);
  const MatrixXd root = covariance.llt().matrixL();
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  int wrong = 0;
  for (int i = 0; i < kRuns; ++i) {
    const VectorXd white =
        VectorXd::NullaryExpr(3, [&](Index) { return normal(generator); });
    const std::vector<bool> named =
        NameFaults(root * white, covariance, kSingles, kAllowed);
    wrong += std::count(named.begin(), named.end(), true) > 0 ? 1 : 0;
  }
  // Four standard deviations of a binomial count.
  const double expected = kAllowed * kRuns;
  EXPECT_LT(wrong, expected + 4.0 * std::sqrt(expected));
  EXPECT_GT(wrong, 0.3 * expected);
}

}  // namespace
}  // namespace mjdiag
