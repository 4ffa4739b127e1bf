#include "mjdiag/diagnosis/statistics/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// To a relative error.
void ExpectClose(double value, double expected, double error = 1e-12) {
  EXPECT_NEAR(value, expected, error * std::abs(expected));
}

// Where nothing else is said the numbers are those of SciPy 1.10, quantiles of t and F by
// scipy.special.betaincinv: those of scipy.stats lose digits where they are rare.

TEST(NormalDensity, IsThatOfMeanAndStandardDeviation) {
  const Eigen::VectorXd density = NormalDensity(Eigen::Vector2d(1.3, -7.0), 0.7, 2.0);
  ExpectClose(density[0], 1.90693908e-01, 1e-8);
  ExpectClose(density[1], 1.20563290e-04, 1e-8);
}

TEST(NormalQuantile, IsExceededWithThatProbability) {
  ExpectClose(NormalQuantile(0.25), 0.6744897501960817);
  ExpectClose(NormalQuantile(0.9), -1.2815515655446004);
  ExpectClose(NormalQuantile(1e-10), 6.361340902404056);
  ExpectClose(NormalQuantile(1e-300), 37.0470962993612);
}

TEST(TwoSidedNormalQuantile, HoldsWhatIsLeftOfTheProbability) {
  ExpectClose(TwoSidedNormalQuantile(0.05), 1.9599639845400545);
  ExpectClose(TwoSidedNormalQuantile(0.317310507862914), 1.0);
  ExpectClose(TwoSidedNormalQuantile(0.01), 2.575829303548901);
  EXPECT_NEAR(TwoSidedNormalQuantile(1.0), 0.0, 1e-12);
}

TEST(StudentQuantile, IsExceededWithThatProbability) {
  ExpectClose(StudentQuantile(5e-4, 1.0), 636.6192487687198);
  ExpectClose(StudentQuantile(5e-4, 8.0), 5.041305433373367);
  ExpectClose(StudentQuantile(0.025, 3.5), 2.9400886379827296);
  ExpectClose(StudentQuantile(1e-9, 20.0), 10.275301852168067);
}

TEST(StudentExceedance, IsTheUpperTail) {
  ExpectClose(StudentExceedance(2.0, 7.0), 0.04280966428148798);
  ExpectClose(StudentExceedance(30.0, 7.0), 5.894234440366563e-09);
  ExpectClose(StudentExceedance(-1.5, 4.0), 0.896);
  EXPECT_EQ(StudentExceedance(std::numeric_limits<double>::infinity(), 7.0), 0.0);
}

TEST(ChiSquaredExceedance, IsWhatTheQuantileIsExceededWith) {
  for (const double dof : {1.0, 3.0, 40.0}) {
    for (const double probability : {0.5, 1e-4, 1e-30}) {
      const double x = ChiSquaredQuantile(probability, dof);
      EXPECT_NEAR(ChiSquaredExceedance(x, dof) / probability, 1.0, 1e-6);
    }
  }
}

// By the series of central ones in 40 digits (mpmath 1.2).
TEST(NoncentralityOf, IsThatOfAVariableWhichExceedsThatMuchSoOften) {
  ExpectClose(NoncentralityOf(10.0, 2.0, 0.025), 0.82612688028967929, 1e-10);
  ExpectClose(NoncentralityOf(10.0, 2.0, 0.975), 24.961087055131787, 1e-10);
  ExpectClose(NoncentralityOf(40.0, 6.0, 0.025), 14.912251793482882, 1e-10);
  ExpectClose(NoncentralityOf(40.0, 6.0, 0.975), 62.900278374793145, 1e-10);
  ExpectClose(NoncentralityOf(906.0, 6.0, 0.025), 787.01788829370966, 1e-10);
  ExpectClose(NoncentralityOf(906.0, 6.0, 0.975), 1022.6702763998000, 1e-10);
  EXPECT_EQ(NoncentralityOf(7.0, 2.0, 0.025), 0.0);  // central: 0.030
}

TEST(ChiSquaredQuantile, IsExceededWithThatProbability) {
  ExpectClose(ChiSquaredQuantile(0.05, 1.0), 3.8414588206941285);
  ExpectClose(ChiSquaredQuantile(1e-4, 1.0), 15.136705226623397);
  ExpectClose(ChiSquaredQuantile(1e-4, 2.0), -2.0 * std::log(1e-4));
  ExpectClose(ChiSquaredQuantile(1e-4, 3.0), 21.10751346616021);
  ExpectClose(ChiSquaredQuantile(1e-8, 5.0), 45.79458712308457);
  ExpectClose(ChiSquaredQuantile(0.3, 2.5), 3.0433328089797267);
  ExpectClose(ChiSquaredQuantile(1e-300, 4.0), 1394.6484227587052);
}

TEST(ChiSquaredQuantile, OfOneDegreeOfFreedomIsTheNormalOneSquared) {
  for (const double probability : {0.9, 0.05, 1e-4, 1e-9}) {
    const double k = TwoSidedNormalQuantile(probability);
    ExpectClose(ChiSquaredQuantile(probability, 1.0), k * k);
  }
}

TEST(FQuantile, IsExceededWithThatProbability) {
  ExpectClose(FQuantile(0.05, 5.0, 10.0), 3.325834530413012);
  ExpectClose(FQuantile(0.5, 2.0, 14.0), 0.7286265957166864);
  ExpectClose(FQuantile(1e-3, 1.0, 15.0), 16.58741634096525);
  ExpectClose(FQuantile(3.3e-8, 12.5, 200.0), 5.449571727473918);
  ExpectClose(FQuantile(1e-6, 1.0, 7.0), 248.59858660166483);
  ExpectClose(FQuantile(1e-12, 30.0, 40.0), 12.915802236737852);
}

// P(F > x) = (1 + 2 x / n)^(-n / 2) for 2 and n degrees of freedom.
TEST(FQuantile, OfTwoDegreesOfFreedomIsThatOfItsClosedForm) {
  for (const double n : {3.0, 14.0, 200.0, 5e4}) {
    for (const double probability : {0.5, 1e-3, 1e-9}) {
      ExpectClose(FQuantile(probability, 2.0, n),
                  0.5 * n * std::expm1(-2.0 / n * std::log(probability)));
    }
  }
}

TEST(FExceedance, IsTheUpperTail) {
  ExpectClose(FExceedance(5.6363, 5.0, 10.0), 0.010000157179864624);
  ExpectClose(FExceedance(0.9, 50.0, 50.0), 0.6445183608194371);
  ExpectClose(FExceedance(1.0808, 24000.0, 2000.0), 0.01001744194706034, 1e-11);
  ExpectClose(FExceedance(9.0, 1000.0, 300.0), 1.5524620060124223e-80, 1e-11);
}

// Of 200 trials at 0.95, 0.5 % count below 181 and 0.5 % above 197.
TEST(BinomialInterval, HoldsAtLeastTheWantedShare) {
  EXPECT_EQ(BinomialInterval(200, 0.95, 0.99), std::pair(181, 197));
  EXPECT_EQ(BinomialInterval(6, 0.95, 0.99), std::pair(4, 6));
  EXPECT_EQ(BinomialInterval(50, 0.1, 0.95), std::pair(1, 9));
  EXPECT_EQ(BinomialInterval(1000, 0.5, 0.9), std::pair(474, 526));
}

// The ends are where a count as extreme has a probability of 2.5 %; of none and of all
// in closed form.
TEST(ProbabilityInterval, EndsWhereTheCountWouldBeASurprise) {
  const auto [low, high] = ProbabilityInterval(200, 190, 0.95);
  EXPECT_NEAR(low, 0.9099725, 1e-7);
  EXPECT_NEAR(high, 0.9757658, 1e-7);
  EXPECT_EQ(ProbabilityInterval(20, 0, 0.95).first, 0.0);
  EXPECT_NEAR(ProbabilityInterval(20, 0, 0.95).second, 1.0 - std::pow(0.025, 0.05),
              1e-12);
  EXPECT_NEAR(ProbabilityInterval(20, 20, 0.95).first, std::pow(0.025, 0.05), 1e-12);
  EXPECT_EQ(ProbabilityInterval(20, 20, 0.95).second, 1.0);
}

TEST(Distributions, AreNanOutsideTheirRanges) {
  for (const double probability : {-0.1, 1.1, kNan}) {
    EXPECT_TRUE(std::isnan(NormalQuantile(probability))) << probability;
    EXPECT_TRUE(std::isnan(StudentQuantile(probability, 3.0))) << probability;
    EXPECT_TRUE(std::isnan(ChiSquaredQuantile(probability, 3.0))) << probability;
    EXPECT_TRUE(std::isnan(FQuantile(probability, 3.0, 3.0))) << probability;
  }
  for (const double dof : {0.0, -1.0, kNan}) {
    EXPECT_TRUE(std::isnan(StudentQuantile(0.1, dof))) << dof;
    EXPECT_TRUE(std::isnan(StudentExceedance(0.1, dof))) << dof;
    EXPECT_TRUE(std::isnan(ChiSquaredQuantile(0.1, dof))) << dof;
    EXPECT_TRUE(std::isnan(FQuantile(0.1, dof, 3.0))) << dof;
    EXPECT_TRUE(std::isnan(FExceedance(0.1, 3.0, dof))) << dof;
  }
}

TEST(Distributions, HaveInfiniteQuantilesOfNothing) {
  EXPECT_EQ(NormalQuantile(0.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(StudentQuantile(0.0, 3.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(ChiSquaredQuantile(0.0, 3.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(FQuantile(0.0, 3.0, 3.0), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace mjdiag
