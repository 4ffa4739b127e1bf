#include "mjdiag/discovery/fault_limits.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/discovery/screening/trial.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/replay/error_dynamics.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kPartsOfRun = 10;

}  // namespace

double HiddenFault(const VectorXd& phi, const VectorXd& e) {
  const double all = phi.squaredNorm();
  const double theta = phi.dot(e) / all;
  // Every part's share of theta: what the record would say with that part doubled.
  const Index length = phi.size() / kPartsOfRun;
  double variance = 0.0;
  for (Index p = 0; p < kPartsOfRun; ++p) {
    const auto part = phi.segment(p * length, length);
    const double share =
        (part.dot(e.segment(p * length, length)) - theta * part.squaredNorm()) / all;
    variance += share * share;
  }
  constexpr double kSigmas = 3.0;
  return std::abs(theta) + kSigmas * std::sqrt(variance * kPartsOfRun /
                                               static_cast<double>(kPartsOfRun - 1));
}

std::map<std::string, double> FaultLimits(const DiscoveryProblem& problem,
                                          const std::vector<Candidate>& candidates,
                                          const Changes& changes) {
  const auto run = problem.Linearised(changes);
  const auto& [track, dynamics] = *run;
  const ObservedMotion motion = problem.MotionOf(track);
  const Index channels = problem.run().outputs.rows();
  const VectorXd residual = Averaged(problem.Scaled(track), channels, dynamics.block());
  const Index skipped = channels * (problem.skip() / dynamics.block());
  std::map<std::string, double> limits;
  for (const Candidate& candidate : candidates) {
    if (!candidate.effect->IsFault()) continue;
    for (const Trial& trial : MakeTrials(problem.machine(), candidate, motion)) {
      const VectorXd phi =
          dynamics.OfForces(trial.entry, trial.signals).rowwise().sum();
      const Index used = phi.size() - skipped;
      limits[candidate.effect->name()] =
          HiddenFault(phi.tail(used), residual.tail(used));
    }
  }
  return limits;
}

}  // namespace mjdiag
