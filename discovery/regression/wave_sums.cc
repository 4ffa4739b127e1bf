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
  // Of twice as many waves as are asked for a Gaussian over eight points of the grid is
  // right to 1e-4 of the largest sum [Greengard 2004, (9) to (14)].
  constexpr Index kFiner = 2;
  constexpr Index kSide = 4;  // points
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const Index waves = std::max<Index>(count, 2);
  const auto size =
      static_cast<Index>(std::bit_ceil(static_cast<std::size_t>(kFiner * waves)));
  const double finer = static_cast<double>(size) / static_cast<double>(waves);
  const double tau = std::numbers::pi * kSide /
                     (finer * (finer - 0.5) * std::pow(static_cast<double>(waves), 2));
  const double step = kTurn / static_cast<double>(size);
  const auto middle = static_cast<double>(waves / 2);
  VectorXcd grid = VectorXcd::Zero(size);
  for (Index k = 0; k < g.size(); ++k) {
    const double turns = increment[k] / kTurn;
    const double place = (turns - std::floor(turns)) * static_cast<double>(size);
    const auto below = static_cast<Index>(place);
    // Waves are counted from the middle one.
    const std::complex<double> value =
        g[k] * std::polar(1.0, angle[k] + middle * increment[k]);
    for (Index i = 1 - kSide; i <= kSide; ++i) {
      const double away = step * (place - static_cast<double>(below + i));
      grid[(below + i + size) % size] += std::exp(-away * away / (4.0 * tau)) * value;
    }
  }
  VectorXcd sums(size);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::Unscaled);
  fft.inv(sums, grid);
  VectorXcd first(count);
  const double scale = std::sqrt(std::numbers::pi / tau) / static_cast<double>(size);
  for (Index m = 0; m < count; ++m) {
    const double wave = static_cast<double>(m) - middle;
    const Index at = (m - waves / 2 + size) % size;
    first[m] = scale * std::exp(wave * wave * tau) * sums[at];
  }
  return first;
}

}  // namespace mjdiag
