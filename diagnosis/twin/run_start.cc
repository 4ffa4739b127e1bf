#include "mjdiag/diagnosis/twin/run_start.h"

#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A reading within this many standard deviations of that at rest is one.
constexpr double kAtRest = 6.0;
/// Part of a first movement by which a faulty machine may differ.
constexpr double kUnlike = 1.0;

}  // namespace

RunStart::RunStart(Index outputs, Index ticks)
    : reading_(VectorXd::Zero(outputs)),
      none_(VectorXd::Zero(outputs)),
      predicted_(MatrixXd::Zero(outputs, 3 * ticks)) {}

bool RunStart::BeganAtRest(Twin& twin, const KeptReadings& kept, VectorXd& theta,
                           Index first_tone) noexcept {
  const Index ticks = predicted_.cols() / 3;
  const Index tones = (theta.size() - twin.start_unknowns() - first_tone) / 2;
  twin.UseGain(0);
  // Without tones, all sines, all cosines.
  for (int run = 0; run < 3; ++run) {
    for (Index i = 0; i < tones; ++i) {
      theta[first_tone + 2 * i] = run == 1 ? 1.0 : 0.0;
      theta[first_tone + 2 * i + 1] = run == 2 ? 1.0 : 0.0;
    }
    twin.Start(theta);
    for (Index k = 0; k < ticks; ++k) {
      twin.Predict(reading_);
      predicted_.col(run * ticks + k) = reading_;
      twin.Step(kept.inputs(k), none_);
    }
  }
  for (Index k = 0; k < ticks; ++k) {
    for (Index i = 0; i < reading_.size(); ++i) {
      const double predicted = predicted_(i, k);
      const double sd = std::sqrt(twin.gains().front().covariance(i, i));
      const double moved = std::abs(predicted - predicted_(i, 0)) +
                           std::abs(predicted_(i, ticks + k) - predicted) +
                           std::abs(predicted_(i, 2 * ticks + k) - predicted);
      if (std::abs(kept.outputs(k)[i] - predicted) > kAtRest * sd + kUnlike * moved) {
        return false;
      }
    }
  }
  return true;
}

Index QuietestTick(const KeptReadings& kept, Index from, Index to, Index block,
                   const MatrixXd& covariance) noexcept {
  Index quietest = from - from % block;
  double least = std::numeric_limits<double>::infinity();
  for (Index k = quietest; k < to; k += block) {
    const auto now = kept.outputs(k);
    const auto before = kept.outputs(k - block);
    double moved = 0.0;
    for (Index i = 0; i < now.size(); ++i) {
      moved += (now[i] - before[i]) * (now[i] - before[i]) / covariance(i, i);
    }
    if (moved < least) {
      least = moved;
      quietest = k;
    }
  }
  return quietest;
}

}  // namespace mjdiag
