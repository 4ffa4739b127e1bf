#pragma once
// Noise that is seeded.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>

namespace mjdiag {

/// Gaussian noise of standard deviation `sd`: white for memory = 0, else
/// x[k] = memory x[k-1] + white noise.
inline Eigen::VectorXd GaussianNoise(Eigen::Index n, double sd, std::uint64_t seed,
                                     double memory = 0.0) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(n);
  double last = sd * normal(generator);
  const double fresh = sd * std::sqrt(1.0 - memory * memory);
  for (double& value : x) {
    value = last;
    last = memory * last + fresh * normal(generator);
  }
  return x;
}

}  // namespace mjdiag
