#include "mjdiag/discovery/checks/likeness.h"

#include <cmath>
#include <map>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Under a Hann window, filled up to a power of two.
VectorXcd TransformOf(const VectorXd& x) {
  Index size = 1;
  while (size < x.size()) size *= 2;
  VectorXd windowed = VectorXd::Zero(size);
  for (Index k = 0; k < x.size(); ++k) {
    const double sine = std::sin(std::numbers::pi * static_cast<double>(k) /
                                 static_cast<double>(x.size()));
    windowed[k] = sine * sine * x[k];
  }
  VectorXcd transform;
  Eigen::FFT<double>().fwd(transform, windowed);
  return transform.head(size / 2 + 1);
}

struct BandPowers {
  double measured = 0.0;
  double expected = 0.0;
  double product = 0.0;
};

/// @param factor  of the whole signals, with its sign
bool AgreeBroadly(const VectorXd& measured, const VectorXd& expected, double factor) {
  constexpr double kMoves = 0.01;  // of the whole power
  constexpr double kLike = 0.5;
  constexpr double kNear = 3.0;
  constexpr int kLeastOctaves = 3;  // two from the middle of the first to the last
  const VectorXcd m = TransformOf(measured);
  const VectorXcd e = TransformOf(expected);
  std::map<int, BandPowers> bands;
  BandPowers whole;
  for (Index k = 1; k < m.size(); ++k) {
    BandPowers& band = bands[std::ilogb(static_cast<double>(k))];
    for (BandPowers* sum : {&band, &whole}) {
      sum->measured += std::norm(m[k]);
      sum->expected += std::norm(e[k]);
      sum->product += (m[k] * std::conj(e[k])).real();
    }
  }
  int octaves = 0;
  for (const auto& [octave, band] : bands) {
    if (band.measured < kMoves * whole.measured ||
        band.expected < kMoves * whole.expected) {
      continue;
    }
    const double correlation = band.product / std::sqrt(band.measured * band.expected);
    const double ratio = std::sqrt(band.measured / band.expected);
    if (correlation * factor < kLike * std::abs(factor)) return false;
    if (std::abs(std::log(ratio / std::abs(factor))) > std::log(kNear)) return false;
    ++octaves;
  }
  return octaves >= kLeastOctaves;
}

}  // namespace

Likeness Liken(const VectorXd& measured, const VectorXd& expected) {
  const VectorXd m = measured.array() - measured.mean();
  const VectorXd e = expected.array() - expected.mean();
  const double product = m.norm() * e.norm();
  if (!(product > 0.0) || !std::isfinite(product)) return {};
  Likeness likeness{m.norm() / e.norm(), m.dot(e) / product};
  likeness.broad =
      AgreeBroadly(m, e, std::copysign(likeness.factor, likeness.correlation));
  return likeness;
}

}  // namespace mjdiag
