// R. Bouc and Y.-K. Wen's hysteresis: a force -z with a memory,
//   dz/dt = stiffness v - loss |v| |z|^(n - 1) z - hardening v |z|^n,  n = exponent
// With exponent 1 and hardening 0 it is Dahl friction (presliding_hysteresis) that slides at
// stiffness / loss. A negative hardening beyond loss lets it grow stiffer with the travel,
// with an exponent of at most 1: with a larger one it would be infinite within a finite way.
//
// Passive for any loss >= 0: with the storage
//   integral of z / (stiffness + (loss - hardening) |z|^n) dz
// it gives back all where it unloads, and where it loads takes more than it stores, since
// dz/dq = stiffness - (loss + hardening) |z|^n is less then. Where hardening exceeds loss,
// |z|^n stays below stiffness / (loss + hardening) and the denominator above 0.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

class BoucWenForce final : public RememberingEffect<BoucWenForce> {
 public:
  BoucWenForce(int dof, const EffectValues& values)
      : stiffness_(values[0]),
        loss_(values[1]),
        hardening_(values[2]),
        exponent_(values[3]),
        dof_(dof) {
    const double slides = loss_ + hardening_;
    if (slides > 0.0) most_ = std::pow(stiffness_ / slides, 1.0 / exponent_);
  }

  bool FollowsItsJoint() const noexcept override { return true; }
  // Over a step v is constant and z a function of the travel v h alone; classical Runge-
  // Kutta in parts short enough for its memory. A stiffer one stays below where it slides.
  void Push(const mjModel& model, mjData& data) noexcept override {
    constexpr double kMostParts = 64.0;
    const double travel = data.qvel[dof_] * model.opt.timestep;
    const double reached =
        std::min(std::abs(z_) + stiffness_ * std::abs(travel), most_);
    const double steep =
        exponent_ > 1.0 ? exponent_ * std::pow(reached, exponent_ - 1.0) : 1.0;
    const double turns =
        std::abs(travel) * (loss_ + std::abs(hardening_)) * std::max(steep, 1.0);
    const double parts = std::clamp(std::ceil(4.0 * turns), 1.0, kMostParts);
    const double part = travel / parts;
    for (int i = 0; i < static_cast<int>(parts); ++i) {
      const double a = Slope(z_, part);
      const double b = Slope(z_ + 0.5 * part * a, part);
      const double c = Slope(z_ + 0.5 * part * b, part);
      const double d = Slope(z_ + part * c, part);
      z_ = std::clamp(z_ + part / 6.0 * (a + 2.0 * b + 2.0 * c + d), -most_, most_);
    }
    data.qfrc_applied[dof_] -= z_;
  }

 private:
  /// dz/dq where the joint moves in the direction of `travel`.
  double Slope(double z, double travel) const noexcept {
    const double size = std::pow(std::min(std::abs(z), most_), exponent_);
    const double against = std::copysign(size, z) * std::copysign(1.0, travel);
    return stiffness_ - loss_ * against - hardening_ * size;
  }

  double stiffness_;
  double loss_;
  double hardening_;
  double exponent_;
  double most_ = std::numeric_limits<double>::infinity();  // at which it slides
  double z_ = 0.0;
  int dof_;
};

EffectParameter WithFallback(EffectParameter parameter, double fallback) {
  parameter.fallback = fallback;
  return parameter;
}

class BoucWenEffect final : public Effect {
 public:
  BoucWenEffect()
      : Effect(
            {.name = "bouc_wen",
             .family = Family::kFriction,
             .kind = Kind::kDryFriction,
             .variable = LawVariable::kPosition,
             .parameters = {NotNegative("stiffness", Role::kAmplitude, "N/m"),
                            NotNegative("loss", Role::kSteepness, "1/m"),
                            Free("hardening", Role::kSteepness, "1/m"),
                            WithFallback(Positive("exponent", Role::kRatio, "1"), 1.0)},
             .meaning = "hysteresis: -z, dz/dt = stiffness v - loss |v| |z|^(n-1) z - "
                        "hardening v |z|^n",
             .odds = kRare}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    if (values[3] > 1.0 && values[2] < -values[1]) {
      throw InputError(Where(*this, ElementName(model, mjOBJ_JOINT, joint)),
                       "hardening = " + std::to_string(values[2]) +
                           " makes it infinite within a finite way",
                       "at least -loss with an exponent > 1");
    }
    return std::make_unique<BoucWenForce>(model.jnt_dofadr[joint], values);
  }
  // As Dahl friction, with a little that hardens, by which the fit sees what more does.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    std::vector<CandidateRegressor> trials;
    for (const double length : LogGrid(1e-2 * Range(q), 0.5 * Range(q), 4)) {
      trials.push_back(
          {-Follow(q, length), at.JointEntry(),
           [length](const Amplitudes& a) -> RegressorValues {
             if (a[0] <= 0.0) return std::nullopt;
             constexpr double kHardens = 0.1;
             return ValuesOf({a[0], (1.0 - kHardens) / length, kHardens / length, 1.0});
           }});
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    const double loss = self.values[1];
    if (loss <= 0.0 || self.values[0] <= 0.0) return std::nullopt;
    return PlacedEffect{Lasting(PreslidingHysteresis()), self.site,
                        ValuesOf({self.values[0] / loss, self.values[0]})};
  }
  // Before it slides it is as stiff as steel.
  EffectValues Spread(const Scales&) const override {
    return ValuesOf({kAnySize, kAnySize, kAnySize, kAnySize});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double length = k.stroke * r.Log(0.01, 0.1);
    const double share = r.Uniform(0.5, 1.0);
    return [=, stiffness = k.FrictionForce() / length](double s) {
      return ValuesOf({s * stiffness, share / length, (1.0 - share) / length, 1.0});
    };
  }
};

}  // namespace

const Effect& BoucWen() {
  static const BoucWenEffect effect;
  return effect;
}

}  // namespace mjdiag
