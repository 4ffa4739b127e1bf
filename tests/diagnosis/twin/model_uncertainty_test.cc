#include "mjdiag/diagnosis/twin/model_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kParts = 16;
const std::vector<Eigen::Index> kFaults = {0, 1};

/// Parts of runs in which two faults and a number of the plant act on three independent
/// readings of unit noise, the faults as if they were `off` in each part.
template <typename Off>
std::vector<std::vector<PartInformation>> Runs(int runs, std::uint64_t seed,
                                               const Off& off) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  std::vector<std::vector<PartInformation>> all(static_cast<std::size_t>(runs));
  for (int run = 0; run < runs; ++run) {
    for (int part = 0; part < kParts; ++part) {
      MatrixXd psi = MatrixXd::Identity(3, 3);
      psi(0, 2) = 0.5;
      VectorXd y = psi * off(run, part);
      for (double& reading : y) reading += noise(random);
      all[static_cast<std::size_t>(run)].push_back(
          {psi.transpose() * psi, psi.transpose() * y});
    }
  }
  // About what they say of the number together.
  double told = 0.0, said = 0.0;
  for (const auto& parts : all) {
    for (const PartInformation& part : parts) {
      told += part.H(2, 2);
      said += part.g[2];
    }
  }
  for (auto& parts : all) {
    for (PartInformation& part : parts) part.g -= said / told * part.H.col(2);
  }
  return all;
}

/// Of the number, told by the runs; of the faults next to nothing is known.
MatrixXd Prior(int runs) {
  return Vector3d(1e-4, 1e-4, 1.25 * kParts * runs).asDiagonal();
}

TEST(ScatterOfParts, IsNothingWhereNoiseExplainsTheParts) {
  // Taken for more with a probability of 1e-3 each.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto none = [](int, int) { return Vector3d::Zero(); };
    EXPECT_FALSE(ScatterOfParts(Runs(1, seed, none), Prior(1), kFaults, false).any())
        << seed;
  }
}

// The variance of a mean of 16 has a relative standard deviation of sqrt(2 / 15); that
// of 40 means of it, 0.06, and a bound of five of them.
TEST(ScatterOfParts, IsWhatPartsDifferByInTheirMean) {
  constexpr double kOff = 10.0;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(1000 + seed);
    std::normal_distribution<double> normal;
    const auto off = [&](int, int) {
      return Vector3d(0.0, kOff * normal(random), 0.0);
    };
    const ModelUncertainty said =
        ScatterOfParts(Runs(1, seed, off), Prior(1), kFaults, false);
    ASSERT_TRUE(said.any()) << seed;
    EXPECT_NEAR(said.freedom, kParts - 1, 1e-6);
    sum += said.covariance(1, 1) / 40.0;
  }
  // With the part of what is usual, p / (freedom + p), which is half of it here.
  const double expected = kOff * kOff / kParts * (15.0 + 2.0 * 0.5) / 17.0;
  // K + 1 over K - 1 is for parts that have told the calibration, too.
  EXPECT_NEAR(sum / expected, 17.0 / 15.0, 0.3);
}

TEST(ScatterOfParts, SeesRunsThatDifferThoughTheirPartsDoNot) {
  constexpr double kOff = 5.0;
  const auto off = [](int run, int) {
    return Vector3d(0.0, run == 0 ? kOff : -kOff, 0.0);
  };
  const ModelUncertainty said =
      ScatterOfParts(Runs(2, 7, off), Prior(2), kFaults, false);
  ASSERT_TRUE(said.any());
  // Of the mean of two runs at least what each is off, over two.
  EXPECT_GT(said.covariance(1, 1), kOff * kOff / 2.0);
}

TEST(ModelUncertainty, IsLargerOfAShorterRun) {
  ModelUncertainty uncertainty;
  uncertainty.duration = 20.0;
  uncertainty.runs = 2;
  EXPECT_EQ(uncertainty.Times(100.0), 3.0);
  EXPECT_EQ(uncertainty.Times(10.0), 3.0);
  EXPECT_EQ(uncertainty.Times(1.0), 21.0);
}

}  // namespace
}  // namespace mjdiag
