#include "mjdiag/discovery/answer/missing_share.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

/// A tenth in force is a hundredth in power: what people who identify machines take for the
/// right model leaves 5 to 10 % of the force.
constexpr double kSmall = 0.1;

/// Of what accelerates the joints: so much is what physics steps are off by, and no discrepancy
/// that anybody means.
constexpr double kNegligible = 1e-3;

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

/// What accelerates every joint with a latent force along the run, rms.
VectorXd UsualForces(const Machine& machine, const MeasuredRun& run,
                     const FilterPath& path) {
  const mjModel& plant = machine.plant();
  const VectorXd mass =
      PlantForces(plant, VectorXd::Map(plant.qpos0, plant.nq)).Mass().diagonal();
  const ObservedMotion motion = MotionAlong(machine, run, path);
  VectorXd usual(path.dof_count());
  for (Eigen::Index j = 0; j < usual.size(); ++j) {
    const Eigen::Index dof = path.dofs[static_cast<std::size_t>(j)];
    usual[j] = mass[dof] * Rms(motion.acceleration.row(dof).transpose());
  }
  return usual;
}

/// Mean square in units of what accelerates the joints, less that of errors.
/// @param counts  which samples do
double PowerOf(const std::vector<DisturbanceEstimate>& forces, const VectorXd& usual,
               const SampleMask& counts) {
  double sum = 0.0;
  for (std::size_t j = 0; j < forces.size(); ++j) {
    const DisturbanceEstimate& force = forces[j];
    const VectorXd counted = Kept(force.value, counts);
    const double square = counted.squaredNorm() / static_cast<double>(counted.size()) -
                          force.sd * force.sd;
    const double scale = usual[static_cast<Eigen::Index>(j)];
    if (scale > 0.0) sum += std::max(0.0, square) / (scale * scale);
  }
  return sum;
}

/// Unseen data beside the machine as given, behind the noise of what fits saw: what is
/// likeliest along other data may take the noise of a reading for a force.
FilterPath BesideUnseen(const AnswerData& data, const ModelOnRuns& nothing) {
  try {
    return RunForceFilter(data.With({}), data.run.unseen, nothing.unseen.dofs,
                          nothing.unseen.starts, nothing.seen.noise);
  } catch (const NumericalError&) {
    return nothing.unseen;
  }
}

}  // namespace

std::vector<DisturbanceEstimate> ForcesBeside(const Machine& changed,
                                              const MeasuredRun& run,
                                              const FilterPath& path) {
  return DisturbanceEstimates(
      changed, RunForceFilter(changed, run, path.dofs, path.starts, path.noise));
}

MissingShare ShareLeft(const AnswerData& data, const UnseenJudgement& judged) {
  const Machine given = data.With({});
  const Model& model = judged.answer.fit.model;
  MissingShare share;
  const VectorXd usual = UsualForces(given, data.run.seen, judged.nothing.seen);
  const SampleMask all_seen = SampleMask::Constant(data.run.seen.samples(), true);
  const auto is_there = [&](const Machine& machine, const FilterPath& path) {
    return AsksForForces(machine, data.run.seen, path) &&
           PowerOf(DisturbanceEstimates(machine, path), usual, all_seen) >
               kNegligible * kNegligible;
  };
  share.is_missing = is_there(given, judged.nothing.seen);
  if (model.empty()) {
    share.left = 1.0;
    share.is_left = share.is_missing;
    return share;
  }
  const Machine changed = data.With(model);
  share.is_left = is_there(changed, judged.answer.seen);
  const auto share_along = [&](const MeasuredRun& run, const FilterPath& path,
                               const SampleMask& counts) {
    const double before = PowerOf(DisturbanceEstimates(given, path), usual, counts);
    if (!(before > 0.0)) return std::numeric_limits<double>::infinity();
    return std::sqrt(PowerOf(ForcesBeside(changed, run, path), usual, counts) / before);
  };
  try {
    share.left = share_along(data.run.unseen, BesideUnseen(data, judged.nothing),
                             data.run.New());
    // A machine that rests in what no fit saw lacks nothing there.
    if (!std::isfinite(share.left)) {
      share.left = share_along(data.run.seen, judged.nothing.seen, all_seen);
    }
  } catch (const NumericalError&) {
    share.left = 1.0;
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
