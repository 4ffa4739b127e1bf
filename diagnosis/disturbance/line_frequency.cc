#include "mjdiag/diagnosis/disturbance/line_frequency.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// The record under a Hann window, turned back by a frequency and summed in blocks
/// short enough to search a bin around it.
struct Demodulated {
  VectorXcd blocks;
  VectorXcd moments;  // the same times time, from the record's middle [s]
  VectorXd time;      // [s] of each block's middle

  /// Power at an offset [Hz], and a multiple of its slope.
  struct Value {
    double power = 0.0;
    double slope = 0.0;
  };
  Value At(double offset) const {
    std::complex<double> sum = 0.0;
    std::complex<double> moment = 0.0;
    for (Index b = 0; b < blocks.size(); ++b) {
      const auto turn = std::polar(1.0, -kTwoPi * offset * time[b]);
      sum += blocks[b] * turn;
      moment += moments[b] * turn;
    }
    return {std::norm(sum), (std::conj(sum) * moment).imag()};
  }
};

double Hann(Index n, Index samples) {
  const double sine = std::sin(std::numbers::pi * (static_cast<double>(n) + 0.5) /
                               static_cast<double>(samples));
  return sine * sine;
}

Demodulated Demodulate(const VectorXd& residual, double sample_time, double frequency,
                       Index block) {
  const Index samples = residual.size();
  const Index count = (samples + block - 1) / block;
  const std::complex<double> turn = std::polar(1.0, -kTwoPi * frequency * sample_time);
  const double middle = 0.5 * static_cast<double>(samples - 1);
  Demodulated result{VectorXcd::Zero(count), VectorXcd::Zero(count), VectorXd(count)};
  for (Index b = 0; b < count; ++b) {
    const auto first = static_cast<double>(b * block);
    result.time[b] =
        sample_time * (first + 0.5 * static_cast<double>(block - 1) - middle);
    auto phasor = std::polar(1.0, -kTwoPi * frequency * sample_time * first);
    for (Index n = b * block; n < std::min(samples, (b + 1) * block); ++n) {
      const auto value = Hann(n, samples) * residual[n] * phasor;
      result.blocks[b] += value;
      result.moments[b] += sample_time * (static_cast<double>(n) - middle) * value;
      phasor *= turn;
    }
  }
  return result;
}

/// Where the power is highest within a bracket, by bisection of its slope: the power
/// itself is too flat to tell.
double Maximum(const Demodulated& signal, double low, double high) {
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (signal.At(middle).slope > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double LineFrequency(const VectorXd& residual, double sample_time, double around,
                     Index segment) {
  const Index block = std::max<Index>(1, segment / 64);
  const double bin = 1.0 / (static_cast<double>(segment) * sample_time);
  const double step = 0.25 / (static_cast<double>(residual.size()) * sample_time);
  const Demodulated coarse = Demodulate(residual, sample_time, around, block);
  double best = 0.0;
  double highest = -1.0;
  for (double offset = -bin; offset <= bin; offset += step) {
    const double power = coarse.At(offset).power;
    if (power > highest) {
      highest = power;
      best = offset;
    }
  }
  // The blocks are exact only at offset 0, so go there: each time some digits nearer,
  // until rounding is what is left.
  double frequency = around + best;
  double last = step;
  constexpr int kMaxMoves = 30;
  for (int i = 0; i < kMaxMoves; ++i) {
    const double move =
        Maximum(Demodulate(residual, sample_time, frequency, block), -step, step);
    frequency += move;
    if (i > 0 && std::abs(move) >= 0.5 * last) break;
    last = std::abs(move);
  }
  return frequency;
}

double LineFrequencySd(Index samples, double sample_time, double amplitude,
                       double density) {
  double inertia = 0.0;
  double scatter = 0.0;
  for (Index n = 0; n < samples; ++n) {
    const double time = sample_time * (static_cast<double>(n) + 0.5 -
                                       0.5 * static_cast<double>(samples));
    const double weighted = Hann(n, samples) * time * time;
    inertia += weighted;
    scatter += Hann(n, samples) * weighted;
  }
  return std::sqrt(density / sample_time * scatter) / (kTwoPi * amplitude * inertia);
}

}  // namespace mjdiag
