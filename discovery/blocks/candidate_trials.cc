#include "mjdiag/discovery/blocks/candidate_trials.h"

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

std::vector<Trial> MakeTrials(const Machine& machine, const Candidate& candidate,
                              const ObservedMotion& motion) {
  const Site site{candidate.site, candidate.joint, candidate.channel};
  std::vector<Trial> trials =
      candidate.effect->Trials({machine.plant(), machine.mechanics(), motion, site});
  // What does not move does not show.
  std::erase_if(trials, [](const Trial& trial) {
    return !trial.signals.allFinite() || trial.signals.cwiseAbs().maxCoeff() == 0.0;
  });
  return trials;
}

std::optional<Sweep> MakeSweep(const Machine& machine, const Candidate& candidate,
                               const ObservedMotion& motion, double duration) {
  const Site site{candidate.site, candidate.joint, candidate.channel};
  return candidate.effect->MakeSweep(
      {machine.plant(), machine.mechanics(), motion, site}, duration);
}

}  // namespace mjdiag
