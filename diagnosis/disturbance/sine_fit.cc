#include "mjdiag/diagnosis/disturbance/sine_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr Index kRows = 1024;  // of the regression held in memory at a time

/// Tukey window, a tenth of the record tapered at each end.
double Tukey(Index n, Index samples) {
  const double edge =
      (std::min(static_cast<double>(n), static_cast<double>(samples - 1 - n)) + 0.5) /
      static_cast<double>(samples);
  if (edge >= 0.1) return 1.0;
  const double sine = std::sin(5.0 * std::numbers::pi * edge);
  return sine * sine;
}

/// sin(2 pi f_j t), cos(2 pi f_j t) in columns 2 j and 2 j + 1.
MatrixXd Sines(const VectorXd& frequency, double sample_time, double start_time,
               Index first, Index count) {
  MatrixXd sines(count, 2 * frequency.size());
  const double time = start_time + sample_time * static_cast<double>(first);
  for (Index j = 0; j < frequency.size(); ++j) {
    const auto turn = std::polar(1.0, kTurn * frequency[j] * sample_time);
    auto phasor = std::polar(1.0, kTurn * frequency[j] * time);
    for (Index n = 0; n < count; ++n) {
      sines(n, 2 * j) = phasor.imag();
      sines(n, 2 * j + 1) = phasor.real();
      phasor *= turn;
    }
  }
  return sines;
}

}  // namespace

VectorXd FitSines(const VectorXd& residual, double sample_time, double start_time,
                  const VectorXd& frequency) {
  const Index unknowns = 2 * frequency.size();
  MatrixXd normal = MatrixXd::Zero(unknowns, unknowns);
  VectorXd right = VectorXd::Zero(unknowns);
  for (Index first = 0; first < residual.size(); first += kRows) {
    const Index count = std::min(kRows, residual.size() - first);
    const MatrixXd sines = Sines(frequency, sample_time, start_time, first, count);
    const VectorXd weight = VectorXd::NullaryExpr(
        count, [&](Index n) { return Tukey(first + n, residual.size()); });
    const MatrixXd weighted = weight.asDiagonal() * sines;
    normal.noalias() += weighted.transpose() * sines;
    right.noalias() += weighted.transpose() * residual.segment(first, count);
  }
  return normal.ldlt().solve(right);
}

double FitVariance(Index samples, double sample_time) {
  double sum = 0.0;
  double squares = 0.0;
  for (Index n = 0; n < samples; ++n) {
    const double weight = Tukey(n, samples);
    sum += weight;
    squares += weight * weight;
  }
  return squares / (sample_time * sum * sum);
}

double DensityAt(const Spectrum& spectrum, double frequency) {
  const double position = std::clamp(frequency / spectrum.resolution(), 0.0,
                                     static_cast<double>(spectrum.density.size() - 1));
  const Index below =
      std::min(static_cast<Index>(position), spectrum.density.size() - 2);
  const double part = position - static_cast<double>(below);
  return (1.0 - part) * spectrum.density[below] + part * spectrum.density[below + 1];
}

VectorXd WithoutSines(VectorXd residual, double sample_time, const VectorXd& frequency,
                      const VectorXd& coefficients) {
  for (Index first = 0; first < residual.size(); first += kRows) {
    const Index count = std::min(kRows, residual.size() - first);
    residual.segment(first, count) -=
        Sines(frequency, sample_time, 0.0, first, count) * coefficients;
  }
  return residual;
}

}  // namespace mjdiag
