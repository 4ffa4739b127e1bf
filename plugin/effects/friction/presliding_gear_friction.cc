// What a strain-wave or cycloidal gear takes of the force tau of its motors on the joint,
// with another share while the motor drives than while the load drives it back, and a
// direction z that turns round over a length instead of at once:
//   dz/dt = (v - |v| z) / length
//   F = -(average |tau| z + difference tau z^2)
//   average = (driving + backdriving) / 2,  difference = (driving - backdriving) / 2
// so that it is driving |tau| or backdriving |tau| once it slides. People who measured such
// gears report that it fits better than LuGre friction with half as many numbers
// (google-deepmind/mujoco, issue 3528, 2026).
//
// Passive under a force that stays the same, where neither share is negative: F = -c(z) z
// with c = |tau| (average + difference sign(tau) z) >= 0 as |z| <= 1, and the storage is
// length |tau| (average z^2 / 2 + difference sign(tau) z^3 / 3) >= 0. It takes |v| c z^2 of
// power more than it stores. A motor that pulls harder on bent teeth puts into that
// storage what it changes by, at most length |tau| times the larger share.

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/effects/friction/bristles.h"
#include "mjdiag/plugin/effects/friction/drive_load.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"

namespace mjdiag {
namespace {

class Teeth final : public RememberingEffect<Teeth> {
 public:
  Teeth(const mjModel& model, int dof, const EffectValues& values)
      : average_(0.5 * (values[0] + values[1])),
        difference_(0.5 * (values[0] - values[1])),
        largest_(values.head(2).maxCoeff()),
        length_(values[2]),
        stiffest_(BristleLimits(model, dof).stiffness),
        dof_(dof) {}

  // Over a step v is constant and z goes to its end on an exponential.
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double v = data.qvel[dof_];
    const double tau = MotorForceOn(model, data, dof_);
    // As a spring it is as stiff as largest |tau| / length.
    const double length = std::max(length_, largest_ * std::abs(tau) / stiffest_);
    const double end = std::copysign(1.0, v);
    z_ = end + (z_ - end) * std::exp(-std::abs(v) * model.opt.timestep / length);
    data.qfrc_applied[dof_] -=
        average_ * std::abs(tau) * z_ + difference_ * tau * z_ * z_;
  }

 private:
  double average_;
  double difference_;
  double largest_;
  double length_;
  double stiffest_;
  double z_ = 0.0;
  int dof_;
};

class PreslidingGearFrictionEffect final : public Effect {
 public:
  PreslidingGearFrictionEffect()
      : Effect({.name = "presliding_gear_friction",
                .family = Family::kFriction,
                .kind = Kind::kLoadFriction,
                .variable = LawVariable::kVelocity,
                // What takes all of what drives it never moves.
                .parameters = {{.name = "driving",
                                .role = Role::kAmplitude,
                                .unit = "1",
                                .minimum = 0.0,
                                .maximum = std::numeric_limits<double>::infinity(),
                                .plausible = 1.0},
                               NotNegative("backdriving", Role::kAmplitude, "1"),
                               Positive("length", Role::kLength, "m")},
                .meaning =
                    "a gear that takes those shares of its motor's force, driving "
                    "and driven back, and turns round over that length",
                .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Teeth>(model, model.jnt_dofadr[joint], values);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    const Eigen::ArrayXd tau = at.motor();
    std::vector<CandidateRegressor> trials;
    // Encoders tell a millionth of their stroke.
    for (const double length : LogGrid(1e-6 * Range(q), 0.5 * Range(q), 12)) {
      const Eigen::ArrayXd z = Follow(q, length).array() / length;
      Eigen::MatrixXd parts(q.size(), 2);
      parts.col(0) = -0.5 * (tau.abs() * z + tau * z.square());
      parts.col(1) = -0.5 * (tau.abs() * z - tau * z.square());
      trials.push_back({parts, at.JointEntry(2),
                        [length](const Amplitudes& a) -> RegressorValues {
                          if (a.minCoeff() < 0.0 || a.maxCoeff() <= 0.0) {
                            return std::nullopt;
                          }
                          return ValuesOf({a[0], a[1], length});
                        },
                        Amplitudes::Zero(2)});
    }
    return trials;
  }
  // Of both sides of the drive, which transmits twice the motor's force where a load is
  // carried.
  std::optional<PlacedEffect> Simpler(const PlacedEffect& self) const override {
    return PlacedEffect{Lasting(LoadFriction()), self.site,
                        ValuesOf({0.25 * (self.values[0] + self.values[1])})};
  }
  // Such gears take a tenth to a third of what drives them, and twist by the flexibility
  // of their teeth before they slide.
  Sized Draw(const Scales& k, Random& r) const override {
    const double share = r.Uniform(0.3, 1.0);
    const double length = k.stroke * r.Log(3e-3, 0.05);
    return [=](double s) { return ValuesOf({0.3 * s * share, 0.3 * s, length}); };
  }
};

}  // namespace

const Effect& PreslidingGearFriction() {
  static const PreslidingGearFrictionEffect effect;
  return effect;
}

}  // namespace mjdiag
