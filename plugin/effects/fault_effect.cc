#include "mjdiag/plugin/effects/fault_effect.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;

// Where a fit ends: far beyond any machine.
constexpr double kMost = 100.0;

/// That of the effect that changes the same attribute of one element.
Family FamilyOf(PlantNumberKind kind) {
  switch (kind) {
    case PlantNumberKind::kDamping:
      return ViscousFriction().family();
    case PlantNumberKind::kGear:
      return MotorConstant().family();
    default:
      return StructuralStiffness().family();
  }
}

class FaultParameterEffect final : public Effect {
 public:
  explicit FaultParameterEffect(FaultParameter declared)
      : Effect({.name = declared.name,
                .family = FamilyOf(declared.kind),
                .kind = KindOf(declared.kind),
                .site = declared.kind == PlantNumberKind::kGear ? SiteKind::kActuator
                                                                : SiteKind::kJoint,
                .form = Form::kAttributes,
                .variable = LawVariable::kVelocity,
                .parameters = {{"value", Role::kFactor, "1", 0.0, kMost}},
                .meaning = "scales a number of the plant"}),
        declared_(std::move(declared)) {}

  bool IsFault() const override { return true; }
  std::vector<Site> CandidateSites(const SiteMap& map) const override;
  std::vector<Trial> Trials(const SiteMotion& at) const override;
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
      site += (site.empty() ? "" : " ") + ElementName(plant, element(), id);
    }
    return site;
  }

 private:
  double Damping(const mjModel& plant) const {
    return plant.dof_damping[plant.jnt_dofadr[declared_.elements.front()]];
  }

  FaultParameter declared_;
};

std::vector<Site> FaultParameterEffect::CandidateSites(const SiteMap& map) const {
  const std::string name = SiteName(map.plant());
  const int first = declared_.elements.front();
  if (declared_.kind != PlantNumberKind::kGear) {
    return {{name, map.plant().jnt_dofadr[first], -1}};
  }
  const std::string motor = ElementName(map.plant(), mjOBJ_ACTUATOR, first);
  for (const Site& site : map.Actuators()) {
    if (site.name == motor) return {{name, site.joint, site.channel}};
  }
  return {};
}

std::vector<Trial> FaultParameterEffect::Trials(const SiteMotion& at) const {
  if (declared_.kind == PlantNumberKind::kGear) {
    return {LinearTrial(at.u(), at.MotorEntry(), 1.0, true)};
  }
  const auto joints = static_cast<Index>(declared_.elements.size());
  Eigen::MatrixXd signals(at.motion.samples(), joints);
  Eigen::MatrixXd entry = Eigen::MatrixXd::Zero(at.model.M.rows(), joints);
  for (Index i = 0; i < joints; ++i) {
    const int joint = declared_.elements[static_cast<std::size_t>(i)];
    const int dof = at.plant.jnt_dofadr[joint];
    const int address = at.plant.jnt_qposadr[joint];
    entry(dof, i) = 1.0;
    if (declared_.kind == PlantNumberKind::kDamping) {
      signals.col(i) = -at.plant.dof_damping[dof] * at.motion.velocity.row(dof);
    } else {
      const double rest = at.plant.qpos_spring[address] - at.plant.qpos0[address];
      signals.col(i) = -at.plant.jnt_stiffness[joint] *
                       (at.motion.position.row(dof).array() - rest).matrix();
    }
  }
  // One amplitude, whatever the number of joints.
  Trial trial = LinearTrial(std::move(signals), std::move(entry), 1.0, true);
  trial.summed = true;
  trial.least.conservativeResize(1);
  return {std::move(trial)};
}

const Effect* FaultParameterEffect::Twin() const {
  if (declared_.elements.size() != 1) return nullptr;
  switch (declared_.kind) {
    case PlantNumberKind::kDamping:
      return &ViscousFriction();
    case PlantNumberKind::kStiffness:
      return &StructuralStiffness();
    case PlantNumberKind::kGear:
      return &MotorConstant();
    default:
      return nullptr;  // no fault parameter is of another kind
  }
}

// Damping is added in N s/m, everything else scaled.
EffectValues FaultParameterEffect::ToTwin(const mjModel& plant,
                                          const EffectValues& values) const {
  if (declared_.kind != PlantNumberKind::kDamping) return values;
  return ValuesOf({(values[0] - 1.0) * Damping(plant)});
}

std::optional<EffectValues> FaultParameterEffect::FromTwin(
    const mjModel& plant, const EffectValues& twin) const {
  if (declared_.kind != PlantNumberKind::kDamping) return twin;
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
