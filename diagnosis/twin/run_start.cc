#include "mjdiag/diagnosis/twin/run_start.h"

#include <algorithm>
#include <cmath>

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

RunStart::RunStart(Index outputs, Index ticks, Index unknowns)
    : reading_(VectorXd::Zero(outputs)),
      none_(reading_),
      spread_(reading_),
      predicted_(MatrixXd::Zero(outputs, 3 * ticks)),
      weighted_(MatrixXd::Zero(unknowns, outputs)) {}

bool RunStart::BeganAtRest(Twin& twin, const KeptReadings& kept, VectorXd& theta,
                           Index first_tone, const MatrixXd& prior) noexcept {
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
    const MatrixXd& psi = twin.EndBlock();
    if (run > 0) continue;
    // At its first tick: tones move it in the course of the block only.
    const auto of_rest = psi.topLeftCorner(twin.outputs(), first_tone);
    auto weighted = weighted_.topRows(first_tone);
    weighted.noalias() =
        prior.topLeftCorner(first_tone, first_tone) * of_rest.transpose();
    for (Index i = 0; i < spread_.size(); ++i) {
      spread_[i] = std::sqrt(of_rest.row(i).dot(weighted.col(i)));
    }
  }
  for (Index i = 0; i < reading_.size(); ++i) {
    // One that was not measured says nothing against it.
    const double sd = std::sqrt(twin.gains().front().covariance(i, i));
    // Where it rests is where the first reading says.
    const double first = kept.outputs(0)[i] - predicted_(i, 0);
    const double away = std::clamp(first, -kAtRest * spread_[i], kAtRest * spread_[i]);
    for (Index k = 0; k < ticks; ++k) {
      const double predicted = predicted_(i, k);
      const double moved = std::abs(predicted - predicted_(i, 0)) +
                           std::abs(predicted_(i, ticks + k) - predicted) +
                           std::abs(predicted_(i, 2 * ticks + k) - predicted);
      if (std::abs(kept.outputs(k)[i] - predicted - away) >
          kAtRest * std::hypot(sd, sd) + kUnlike * moved) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace mjdiag
