#include "mjdiag/discovery/answer/missing_power.h"

#include <algorithm>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/plugin/plant/plant_forces.h"

namespace mjdiag {

using Eigen::VectorXd;

std::vector<MissingForce> ForcesBeside(const Machine& changed, const MeasuredRun& run,
                                       const FilterPath& path) {
  return MissingForces(
      changed, RunForceFilter(changed, run, path.dofs, path.starts, path.noise));
}

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

VectorXd PowerOf(const std::vector<MissingForce>& forces, const SampleMask& counts) {
  VectorXd power(std::ssize(forces));
  for (std::size_t j = 0; j < forces.size(); ++j) {
    const MissingForce& force = forces[j];
    const VectorXd counted = Kept(force.value, counts);
    const double square = counted.squaredNorm() / static_cast<double>(counted.size()) -
                          force.sd * force.sd;
    power[static_cast<Eigen::Index>(j)] = std::max(0.0, square);
  }
  return power;
}

double InUnitsOf(const VectorXd& usual, const VectorXd& power) {
  return (usual.array() > 0.0).select(power.array() / usual.array().square(), 0.0).sum();
}

MissingPower::MissingPower(const AnswerData& data, const ModelOnRuns& nothing)
    : run_(&data.run.unseen), path_(&nothing.unseen), counts_(data.run.New()) {
  const Machine given = data.With({});
  const VectorXd usual = UsualForces(given, data.run.seen, nothing.seen);
  given_ = PowerOf(MissingForces(given, *path_), counts_);
  if (given_.isZero(0.0)) {
    run_ = &data.run.seen;
    path_ = &nothing.seen;
    counts_ = SampleMask::Constant(run_->samples(), true);
    given_ = PowerOf(MissingForces(given, *path_), counts_);
  }
  constexpr double kHundredth = 0.01;
  least_ = (kHundredth * kHundredth * given_)
               .cwiseMax(kNegligible * kNegligible * usual.cwiseAbs2());
}

bool MissingPower::WouldBeMissed(const VectorXd& with, const VectorXd& without) const {
  return ((without - with).array() > least_.array()).any();
}

VectorXd MissingPower::Of(const Machine& changed) const {
  return PowerOf(ForcesBeside(changed, *run_, *path_), counts_);
}

}  // namespace mjdiag
