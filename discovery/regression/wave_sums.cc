#include "mjdiag/discovery/regression/wave_sums.h"

#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXcd WaveSums(const VectorXd& g, const VectorXd& angle, const VectorXd& increment,
                   Index count) {
  constexpr Index kFiner = 16;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const auto size = static_cast<Index>(
      std::bit_ceil(static_cast<std::size_t>(kFiner * std::max<Index>(count, 1))));
  VectorXcd grid = VectorXcd::Zero(size);
  for (Index k = 0; k < g.size(); ++k) {
    const double turns = increment[k] / kTurn;
    const double place = (turns - std::floor(turns)) * static_cast<double>(size);
    const auto below = static_cast<Index>(place);
    const double above = place - static_cast<double>(below);
    const std::complex<double> value = g[k] * std::polar(1.0, angle[k]);
    grid[below % size] += (1.0 - above) * value;
    grid[(below + 1) % size] += above * value;
  }
  VectorXcd sums(size);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::Unscaled);
  fft.inv(sums, grid);
  VectorXcd first(count);
  for (Index m = 0; m < count; ++m) {
    // Of the triangle that every value is spread by.
    const double x =
        std::numbers::pi * static_cast<double>(m) / static_cast<double>(size);
    const double spread = m == 0 ? 1.0 : std::sin(x) / x;
    first[m] = sums[m] / (spread * spread);
  }
  return first;
}

}  // namespace mjdiag
