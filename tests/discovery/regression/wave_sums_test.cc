#include "mjdiag/discovery/regression/wave_sums.h"

#include <gtest/gtest.h>

#include <complex>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

TEST(WaveSums, AreThoseOfEveryWaveByItself) {
  constexpr Index kSamples = 500;
  constexpr Index kWaves = 60;
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  const auto random = [&] { return normal(generator); };
  const VectorXd g = VectorXd::NullaryExpr(kSamples, random);
  // Of a motion to and fro: increments of either sign, more than a turn, too.
  const VectorXd x = VectorXd::NullaryExpr(kSamples, random);
  const VectorXd angle = 4.0 * x;
  const Eigen::VectorXcd sums = WaveSums(g, angle, x, kWaves);
  for (Index m = 0; m < kWaves; ++m) {
    std::complex<double> sum = 0.0;
    for (Index k = 0; k < kSamples; ++k) {
      sum += g[k] * std::polar(1.0, angle[k] + static_cast<double>(m) * x[k]);
    }
    EXPECT_LT(std::abs(sums[m] - sum), 1e-3 * g.norm()) << m;
  }
}

}  // namespace
}  // namespace mjdiag
