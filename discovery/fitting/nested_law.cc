#include "mjdiag/discovery/fitting/nested_law.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The first of the causes that is a candidate.
std::optional<FittedCause> AsCandidate(const std::vector<Candidate>& candidates,
                                       const std::vector<Cause>& causes) {
  for (const Cause& cause : causes) {
    const auto found =
        std::ranges::find_if(candidates, [&](const Candidate& candidate) {
          return SameKind({candidate.effect, candidate.site, {}}, cause);
        });
    if (found == candidates.end()) continue;
    return Bounded(candidates, {static_cast<std::size_t>(found - candidates.begin()),
                                cause.values});
  }
  return std::nullopt;
}

}  // namespace

std::optional<FittedCause> SimplerLaw(const mjModel& plant,
                                      const std::vector<Candidate>& candidates,
                                      const FittedCause& cause) {
  const Cause present = CauseOf(candidates, cause);
  const auto simpler = present.effect->Simpler(present);
  if (!simpler) return std::nullopt;
  std::vector<Cause> same = Twins(plant, *simpler);
  same.insert(same.begin(), *simpler);
  return AsCandidate(candidates, same);
}

// Gauss and Newton, with the shortest step, in the logs of what is positive: most laws
// become products of their values.
FittedCause Containing(const mjModel& plant, const std::vector<Candidate>& candidates,
                       FittedCause larger, const FittedCause& simpler) {
  constexpr int kSteps = 8;
  constexpr double kDifference = 1e-6;
  const Index count = larger.value.size();
  for (int step = 0; step < kSteps; ++step) {
    const auto here = SimplerLaw(plant, candidates, larger);
    if (!here || here->candidate != simpler.candidate) break;
    VectorXd missing = simpler.value - here->value;
    MatrixXd slope = MatrixXd::Zero(missing.size(), count);
    for (Index i = 0; i < count; ++i) {
      FittedCause moved = larger;
      moved.value[i] += kDifference * std::abs(larger.value[i]);
      const auto there = SimplerLaw(plant, candidates, moved);
      if (there) slope.col(i) = (there->value - here->value) / kDifference;
    }
    for (Index k = 0; k < missing.size(); ++k) {
      if (!(here->value[k] > 0.0 && simpler.value[k] > 0.0)) continue;
      missing[k] = std::log(simpler.value[k] / here->value[k]);
      slope.row(k) /= here->value[k];
    }
    const VectorXd change = slope.completeOrthogonalDecomposition().solve(missing);
    for (Index i = 0; i < count; ++i) {
      double& value = larger.value[i];
      value += value > 0.0 ? value * std::expm1(change[i]) : -value * change[i];
    }
    larger = Bounded(candidates, std::move(larger));
  }
  return larger;
}

}  // namespace mjdiag
