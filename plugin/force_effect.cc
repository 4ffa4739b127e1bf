#include "mjdiag/plugin/force_effect.h"

namespace mjdiag {
namespace {

/// tau = force
class ForceOffset final : public ForceEffect {
 public:
  ForceOffset(int dof, double force) : dof_(dof), force_(force) {}
  void AddForce(const mjModel&, mjData& data) noexcept override {
    data.qfrc_applied[dof_] += force_;
  }

 private:
  int dof_;
  double force_;
};

}  // namespace

ForceEffects::ForceEffects(const mjModel& model, const std::vector<EffectSpec>& added) {
  std::vector<EffectSpec> all = EffectsOf(model);
  all.insert(all.end(), added.begin(), added.end());
  for (const EffectSpec& spec : all) {
    const int site = CheckEffect(model, spec);
    if (FindEffect(spec.effect).native) continue;
    dofs_.push_back(model.jnt_dofadr[site]);
    effects_.push_back(
        std::make_unique<ForceOffset>(dofs_.back(), spec.parameters.at("force")));
  }
}

void ForceEffects::Apply(const mjModel& model, mjData& data) noexcept {
  Release(data);
  for (const auto& effect : effects_) effect->AddForce(model, data);
}

void ForceEffects::Release(mjData& data) noexcept {
  for (const int dof : dofs_) data.qfrc_applied[dof] = 0.0;
}

}  // namespace mjdiag
