#include "mjdiag/plugin/effects/fault_effect.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/tendon_moment.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// Where a fit ends: far beyond any machine.
constexpr double kMost = 100.0;

Family FamilyOf(ModelParameterKind kind) {
  if (IsDrive(kind)) return Family::kDrive;
  if (IsFriction(kind) || KindOf(kind) == Kind::kViscousFriction) {
    return Family::kFriction;
  }
  return Family::kStructure;
}

/// The degree of freedom that a body hangs on; -1: none.
int DofOfBody(const mjModel& plant, int body) {
  while (body > 0 && plant.body_dofnum[body] == 0) body = plant.body_parentid[body];
  return body > 0 ? plant.body_dofadr[body] : -1;
}

/// The one by which a tendon grows longer most, as the plant is drawn.
int DofOfTendon(const mjModel& plant, int tendon) {
  Index dof = -1;
  TendonMoments(plant, plant.qpos0).col(tendon).cwiseAbs().maxCoeff(&dof);
  return static_cast<int>(dof);
}

/// Speeds below which a joint may be held, as Direction() has them.
Eigen::VectorXd StillSpeeds(const ObservedMotion& motion) {
  constexpr double kStill = 1.0 / 200.0;
  return kStill * motion.velocity.cwiseAbs().rowwise().maxCoeff();
}

class FaultParameterEffect final : public Effect {
 public:
  explicit FaultParameterEffect(FaultParameter declared)
      : Effect({.name = declared.name,
                .family = FamilyOf(declared.kind),
                .kind = KindOf(declared.kind),
                .site = IsDrive(declared.kind) ? SiteKind::kActuator : SiteKind::kJoint,
                .form = Form::kAttributes,
                .variable = LawVariable::kVelocity,
                .parameters = {{"value", Role::kFactor, "1", 0.0, kMost}},
                .meaning = "scales a number of the plant"}),
        declared_(std::move(declared)) {}

  bool IsFault() const override { return true; }
  std::vector<Site> CandidateSites(const SiteMap& map) const override;
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override;
  const Effect* Twin() const override;
  EffectValues ToTwin(const mjModel& plant, const EffectValues& values) const override;
  std::optional<EffectValues> FromTwin(const mjModel& plant,
                                       const EffectValues& twin) const override;
  Sized Draw(const Scales&, Random& r) const override {
    return AroundOne(r.Sign() * 0.5);
  }

  std::string SiteName(const mjModel& plant) const {
    std::string site;
    for (const int id : declared_.elements) {
      site +=
          (site.empty() ? "" : " ") + ElementName(plant, ElementOf(declared_.kind), id);
    }
    return site;
  }

 private:
  CandidateRegressor RegressorOfNumbers(const SiteMotion& at) const;
  double Damping(const mjModel& plant) const {
    return plant.dof_damping[plant.jnt_dofadr[declared_.elements.front()]];
  }

  FaultParameter declared_;
};

std::vector<Site> FaultParameterEffect::CandidateSites(const SiteMap& map) const {
  const std::string name = SiteName(map.plant());
  const mjModel& plant = map.plant();
  const int first = declared_.elements.front();
  int dof = -1;
  switch (ElementOf(declared_.kind)) {
    case mjOBJ_JOINT:
      dof = plant.jnt_dofadr[first];
      break;
    case mjOBJ_BODY:
      dof = DofOfBody(plant, first);
      break;
    case mjOBJ_TENDON:
      dof = DofOfTendon(plant, first);
      break;
    default: {
      const std::string motor = ElementName(plant, mjOBJ_ACTUATOR, first);
      for (const Site& site : map.Actuators()) {
        if (site.name == motor) return {{name, site.joint, site.channel}};
      }
    }
  }
  if (dof < 0) return {};
  return {{name, dof, -1}};
}

/// Along the motion, whatever the numbers do.
CandidateRegressor FaultParameterEffect::RegressorOfNumbers(
    const SiteMotion& at) const {
  std::vector<int> actuators(static_cast<std::size_t>(at.motion.inputs.rows()), -1);
  if (at.site.channel >= 0) {
    actuators[static_cast<std::size_t>(at.site.channel)] = declared_.elements.front();
  }
  const Eigen::VectorXd still = StillSpeeds(at.motion);
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(at.motion.samples(), at.plant.nv);
  for (const int id : declared_.elements) {
    force += NumberForce(at.plant, actuators, {declared_.kind, id}, at.motion, still);
  }
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(at.plant.nv, at.plant.nv);
  std::vector<Index> pushed;
  for (Index dof = 0; dof < force.cols(); ++dof) {
    if (!force.col(dof).isZero(0.0)) pushed.push_back(dof);
  }
  if (pushed.empty()) pushed.push_back(0);
  return LinearRegressor(force(Eigen::all, pushed), all(Eigen::all, pushed), 1.0, true);
}

std::vector<CandidateRegressor> FaultParameterEffect::CandidateRegressors(
    const SiteMotion& at) const {
  if (declared_.kind == ModelParameterKind::kGear) {
    return {LinearRegressor(at.u(), at.MotorEntry(), 1.0, true)};
  }
  const auto as_one = [](CandidateRegressor trial) {
    // One amplitude, whatever the number of joints.
    trial.summed = true;
    trial.least.conservativeResize(1);
    return std::vector<CandidateRegressor>{std::move(trial)};
  };
  if (declared_.kind != ModelParameterKind::kDamping &&
      declared_.kind != ModelParameterKind::kStiffness) {
    return as_one(RegressorOfNumbers(at));
  }
  const auto joints = static_cast<Index>(declared_.elements.size());
  Eigen::MatrixXd signals(at.motion.samples(), joints);
  Eigen::MatrixXd entry = Eigen::MatrixXd::Zero(at.model.M.rows(), joints);
  for (Index i = 0; i < joints; ++i) {
    const int joint = declared_.elements[static_cast<std::size_t>(i)];
    const int dof = at.plant.jnt_dofadr[joint];
    const int address = at.plant.jnt_qposadr[joint];
    entry(dof, i) = 1.0;
    if (declared_.kind == ModelParameterKind::kDamping) {
      signals.col(i) = -at.plant.dof_damping[dof] * at.motion.velocity.row(dof);
    } else {
      const double rest = at.plant.qpos_spring[address] - at.plant.qpos0[address];
      signals.col(i) = -at.plant.jnt_stiffness[joint] *
                       (at.motion.position.row(dof).array() - rest).matrix();
    }
  }
  return as_one(LinearRegressor(std::move(signals), std::move(entry), 1.0, true));
}

const Effect* FaultParameterEffect::Twin() const {
  if (declared_.elements.size() != 1) return nullptr;
  switch (declared_.kind) {
    case ModelParameterKind::kDamping:
      return &ViscousFriction();
    case ModelParameterKind::kStiffness:
      return &StructuralStiffness();
    case ModelParameterKind::kGear:
      return &MotorConstant();
    default:
      return nullptr;
  }
}

// Damping is added in N s/m, everything else scaled.
EffectValues FaultParameterEffect::ToTwin(const mjModel& plant,
                                          const EffectValues& values) const {
  if (declared_.kind != ModelParameterKind::kDamping) return values;
  return ValuesOf({(values[0] - 1.0) * Damping(plant)});
}

std::optional<EffectValues> FaultParameterEffect::FromTwin(
    const mjModel& plant, const EffectValues& twin) const {
  if (declared_.kind != ModelParameterKind::kDamping) return twin;
  if (Damping(plant) == 0.0) return std::nullopt;
  return ValuesOf({1.0 + twin[0] / Damping(plant)});
}

}  // namespace

EffectPtr FaultEffect(FaultParameter declared) {
  return std::make_shared<FaultParameterEffect>(std::move(declared));
}

std::vector<PlacedEffect> FaultEffects(const mjModel& plant) {
  std::vector<PlacedEffect> placed;
  for (FaultParameter& declared : FaultParameters(plant)) {
    const auto effect = std::make_shared<FaultParameterEffect>(std::move(declared));
    placed.push_back({effect, effect->SiteName(plant), ValuesOf({1.0})});
  }
  return placed;
}

}  // namespace mjdiag
