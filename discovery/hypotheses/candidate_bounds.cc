#include "mjdiag/discovery/hypotheses/candidate_bounds.h"

#include <algorithm>
#include <map>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/trial_signals.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void Narrow(FitParameter& parameter, double lower, double upper) {
  if (!(upper > lower)) return;  // no motion
  parameter.lower = std::max(parameter.lower, lower);
  parameter.upper = std::min(parameter.upper, upper);
}

}  // namespace

void BoundByRecord(std::vector<Candidate>& candidates, const Machine& machine,
                   const ObservedMotion& motion) {
  // Waves and resonances come round within what is seen, or they are something else.
  constexpr double kOnce = 1.1;    // strokes a period, at most
  constexpr double kSwings = 2.0;  // in the longest record, at least
  std::map<Index, Scales> scales;  // of every joint
  for (Candidate& candidate : candidates) {
    const Site site{candidate.site, candidate.joint, candidate.channel};
    const SiteMotion at{machine.plant(), machine.linear(), motion, site};
    if (!scales.contains(candidate.joint)) scales[candidate.joint] = ScalesOf(at);
    const Scales& own = scales[candidate.joint];
    const VectorXd spread = candidate.effect->Spread(own);
    Index place = 0;
    const VectorXd q = at.q();
    for (FitParameter& parameter : candidate.parameters) {
      const double expected = spread[place++];
      if (expected > 0.0) parameter.spread = expected;
      switch (parameter.role) {
        case Role::kVelocity:
          Narrow(parameter, 1e-3 * own.speed, 2.0 * own.speed);
          break;
        case Role::kLength:
          Narrow(parameter, 1e-5 * own.stroke, 10.0 * own.stroke);
          break;
        case Role::kPosition:
          Narrow(parameter, q.minCoeff(), q.maxCoeff());
          break;
        case Role::kFrequency:
          Narrow(parameter, kSwings / motion.time.maxCoeff(), 0.5 / motion.sample_time);
          break;
        case Role::kPeriod:
          Narrow(parameter, 0.0,
                 kOnce * (candidate.effect->site() == SiteKind::kSensor ? Range(at.y())
                                                                        : own.stroke));
          break;
        case Role::kLimit:
          Narrow(parameter, 0.0, at.before_gear().cwiseAbs().maxCoeff());
          break;
        default:
          break;
      }
    }
  }
}

}  // namespace mjdiag
