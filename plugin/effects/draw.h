#pragma once
// How a benchmark draws effects to hide: shapes at random, sizes in proportion to what
// the machine has. Ranges are those of machines: dry friction of up to 30 % of the motor's
// force, gains that are off by as much, and so on.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "mjdiag/plugin/effects/scales.h"

namespace mjdiag {

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  double Uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(generator_);
  }
  double Log(double from, double to) {
    return std::exp(Uniform(std::log(from), std::log(to)));
  }
  double Normal() { return std::normal_distribution<double>()(generator_); }
  double Sign() { return Uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0; }
  std::size_t Index(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(generator_);
  }

 private:
  std::mt19937_64 generator_;
};

/// Values of the parameters, in their order, at a size from 0 (nothing) to 1 (large).
using Sized = std::function<Eigen::VectorXd(double size)>;

/// Of effects with one parameter.
inline Sized Proportional(double large) {
  return [=](double s) { return Eigen::VectorXd::Constant(1, s * large); };
}
inline Sized AroundOne(double change) {
  return [=](double s) { return Eigen::VectorXd::Constant(1, 1.0 + s * change); };
}

}  // namespace mjdiag
