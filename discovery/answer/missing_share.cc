#include "mjdiag/discovery/answer/missing_share.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/comparison/mismatch.h"
#include "mjdiag/discovery/answer/missing_power.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

/// A tenth in force is a hundredth in power: what people who identify machines take for the
/// right model leaves 5 to 10 % of the force.
constexpr double kSmall = 0.1;

/// What latent forces of a joint cost, 2 ln 20 for the claim and for each of their three
/// numbers what a parameter of a model costs that is told to a tenth.
constexpr double kForcePrice = 6.0 + 3.0 * 4.6;

/// Whether fitted data ask for latent forces beside a machine.
bool AsksForForces(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path) {
  FilterNoise none = path.noise;
  constexpr double kNone = 1e-6;
  none.size *= kNone;
  none.white *= kNone;
  try {
    const FilterPath without =
        RunForceFilter(machine, run, path.dofs, path.starts, none);
    return without.deviance - path.deviance >
           kForcePrice * static_cast<double>(path.dof_count());
  } catch (const NumericalError&) {
    return true;  // it does not stay beside the run without them
  }
}

}  // namespace

MissingShare ShareLeft(const AnswerData& data, const UnseenJudgement& judged) {
  const Machine given = data.With({});
  const Model& model = judged.answer.fit.model;
  MissingShare share;
  const VectorXd usual = UsualForces(given, data.run.seen, judged.nothing.seen);
  const SampleMask all_seen = SampleMask::Constant(data.run.seen.samples(), true);
  const auto is_there = [&](const Machine& machine, const FilterPath& path) {
    return AsksForForces(machine, data.run.seen, path) &&
           InUnitsOf(usual, PowerOf(MissingForces(machine, path), all_seen)) >
               kNegligible * kNegligible;
  };
  share.is_missing = is_there(given, judged.nothing.seen);
  share.left = 1.0;
  if (model.empty()) {
    share.is_left = share.is_missing;
    return share;
  }
  const Machine changed = data.With(model);
  share.is_left = is_there(changed, judged.answer.seen);
  try {
    const MissingPower power(data, judged.nothing);
    const double before = InUnitsOf(usual, power.given());
    if (before > 0.0) share.left = std::sqrt(InUnitsOf(usual, power.Of(changed)) / before);
  } catch (const NumericalError&) {
  }
  return share;
}

DiscoveryVerdict VerdictOf(const MissingShare& share, bool has_model) {
  if (!has_model) {
    return share.is_missing ? DiscoveryVerdict::kUnexplained
                            : DiscoveryVerdict::kNoDiscrepancy;
  }
  return !share.is_left || share.left < kSmall ? DiscoveryVerdict::kExplained
                                               : DiscoveryVerdict::kPartlyExplained;
}

}  // namespace mjdiag
