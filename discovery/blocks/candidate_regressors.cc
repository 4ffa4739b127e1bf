#include "mjdiag/discovery/blocks/candidate_regressors.h"

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

std::vector<CandidateRegressor> MakeCandidateRegressors(const Machine& machine,
                                                        const Candidate& candidate,
                                                        const ObservedMotion& motion) {
  const Site site{candidate.site, candidate.joint, candidate.channel};
  std::vector<CandidateRegressor> trials = candidate.effect->CandidateRegressors(
      {machine.plant(), machine.mechanics(), motion, site});
  // What does not move does not show.
  std::erase_if(trials, [](const CandidateRegressor& trial) {
    return !trial.signals.allFinite() || trial.signals.cwiseAbs().maxCoeff() == 0.0;
  });
  return trials;
}

std::optional<ParameterScan> MakeParameterScan(const Machine& machine,
                                               const Candidate& candidate,
                                               const ObservedMotion& motion,
                                               double duration) {
  const Site site{candidate.site, candidate.joint, candidate.channel};
  return candidate.effect->MakeParameterScan(
      {machine.plant(), machine.mechanics(), motion, site}, duration);
}

}  // namespace mjdiag
