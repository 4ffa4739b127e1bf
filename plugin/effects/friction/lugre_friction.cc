// Bristles of the mean bend z that slide (C. Canudas de Wit, H. Olsson, K. J. Astrom and
// P. Lischinsky, "A new model for control of systems with friction", IEEE Trans. Automatic
// Control 40, 1995):
//   dz/dt = v - stiffness |v| z / g(v),  g(v) = coulomb + breakaway exp(-(v / velocity)^2)
//   force -(stiffness z + d(v) dz/dt)
// What viscous friction there is beside it is viscous_friction.
//
// Passive with the storage stiffness z^2 / 2: with r = stiffness z sign(v) / g it takes
//   g |v| r^2 + d v^2 (1 - r) >= d v^2 (1 - d |v| / (4 g))
// of power more than it stores. A constant d exceeds 4 g / |v| at speed and may drive
// (N. Barabanov and R. Ortega, IEEE Trans. Automatic Control 45, 2000), so the damper is
// one of those that fade (H. Olsson, "Control systems with friction", 1996):
//   d(v) = damping / (1 + damping |v| / (4 g(v)))
// is below 4 g / |v| for any damping, and as good as constant before it slides.

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/friction/bristles.h"
#include "mjdiag/plugin/effects/friction/stribeck_curve.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class Bristles {
 public:
  /// @param values  of the parameters
  explicit Bristles(const EffectValues& values)
      : coulomb_(values[0]),
        breakaway_(values[1]),
        velocity_(values[2]),
        stiffness_(values[3]),
        damping_(values[4]) {}

  void Limit(const BristleLimits& limits) {
    stiffness_ = std::min(stiffness_, limits.stiffness);
    damping_ = std::min(damping_, limits.damping);
  }

  /// The force of a step h in which v is constant. z goes to its end on an exponential
  /// then, however short that is, and its damper sees the mean of dz/dt.
  double Step(double v, double h) noexcept {
    const double g = coulomb_ + breakaway_ * StribeckShare(v, velocity_);
    if (!(g > 0.0)) {
      z_ = 0.0;
      return 0.0;
    }
    const double before = z_;
    const double end = std::copysign(g / stiffness_, v);
    z_ = end + (z_ - end) * std::exp(-stiffness_ * std::abs(v) * h / g);
    const double damping = damping_ / (1.0 + 0.25 * damping_ * std::abs(v) / g);
    return -(stiffness_ * z_ + damping * (z_ - before) / h);
  }

 private:
  double coulomb_;
  double breakaway_;
  double velocity_;
  double stiffness_;
  double damping_;
  double z_ = 0.0;  // [m]
};

class BristleForce final : public RememberingEffect<BristleForce> {
 public:
  BristleForce(const mjModel& model, int dof, const EffectValues& values)
      : bristles_(values), dof_(dof) {
    bristles_.Limit({model, dof});
  }
  bool FollowsItsJoint() const noexcept override { return true; }
  void Push(const mjModel& model, mjData& data) noexcept override {
    data.qfrc_applied[dof_] += bristles_.Step(data.qvel[dof_], model.opt.timestep);
  }

 private:
  Bristles bristles_;
  int dof_;
};

class LugreFrictionEffect final : public Effect {
 public:
  LugreFrictionEffect()
      : Effect({.name = "lugre_friction",
                .family = Family::kFriction,
                .kind = Kind::kDryFriction,
                .variable = LawVariable::kVelocity,
                .parameters = {NotNegative("coulomb", Role::kAmplitude, "N"),
                               NotNegative("breakaway", Role::kAmplitude, "N"),
                               Positive("velocity", Role::kVelocity, "m/s"),
                               Positive("stiffness", Role::kSteepness, "N/m"),
                               NotNegative("damping", Role::kSteepness, "N s/m")},
                .meaning = "bristles with that stiffness and damping, which slide at "
                           "coulomb + breakaway exp(-(v / velocity)^2)",
                .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<BristleForce>(model, model.jnt_dofadr[joint], values);
  }
  // The force is proportional to what it slides at, for bristles of the same length and
  // damped as much for their stiffness.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd v = at.v();
    const double top = v.cwiseAbs().maxCoeff();
    const double mass = at.model.M(at.site.joint, at.site.joint);
    std::vector<CandidateRegressor> trials;
    for (const double length : LogGrid(1e-4 * Range(at.q()), 0.1 * Range(at.q()), 4)) {
      for (const double velocity : LogGrid(0.01 * top, 0.3 * top, 3)) {
        for (const double share : {0.3, 0.6}) {
          const double damping = kDamped * std::sqrt(mass / length);
          const EffectValues unit =
              ValuesOf({1.0 - share, share, velocity, 1.0 / length, 0.0});
          trials.push_back({Along(v, at.motion.sample_time, unit), at.JointEntry(),
                            [unit, damping](const Amplitudes& a) -> RegressorValues {
                              if (a[0] <= 0.0) return std::nullopt;
                              EffectValues values = unit * a[0];
                              values[2] = unit[2];
                              values[4] = damping * std::sqrt(a[0]);
                              return values;
                            }});
        }
      }
    }
    return trials;
  }
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(StribeckFriction()), self.site, self.values.head(3)};
  }
  std::optional<double> Law(double v, const EffectValues& values) const override {
    return -Sign(v) * (values[0] + values[1] * StribeckShare(v, values[2]));
  }
  // The bristles are as long as presliding of guides, and damped to a tenth of what they
  // are critically with the mass.
  Sized Draw(const Scales& k, Random& r) const override {
    const double force = k.FrictionForce();
    const double length = k.stroke * r.Log(3e-3, 0.05);
    const double velocity = k.speed * r.Log(0.05, 0.3);
    const double share = r.Uniform(0.3, 0.7);
    const double damping = kDamped * std::sqrt(force * k.mass / length);
    return [=](double s) {
      return ValuesOf({(1.0 - share) * s * force, share * s * force, velocity,
                       s * force / length, std::sqrt(s) * damping});
    };
  }

 private:
  /// Of sqrt(stiffness mass): a damping ratio of a tenth.
  static constexpr double kDamped = 0.2;

  static Eigen::VectorXd Along(const Eigen::VectorXd& v, double h,
                               const EffectValues& values) {
    Bristles bristles(values);
    return v.unaryExpr([&](double speed) { return bristles.Step(speed, h); });
  }
};

}  // namespace

const Effect& LugreFriction() {
  static const LugreFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
