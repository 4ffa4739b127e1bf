#include "mjdiag/studies/outside_law.h"

#include <algorithm>
#include <memory>

#include "mjdiag/plugin/effects/joint_force.h"

namespace mjdiag {
namespace {

class Deaf final : public ActiveEffect {
 public:
  Deaf(int actuator, double width) : width_(width), actuator_(actuator) {}
  void Drive(const mjModel&, mjData& data) noexcept override {
    mjtNum& command = data.ctrl[actuator_];
    command -= std::clamp(command, -width_, width_);
  }

 private:
  double width_;
  int actuator_;
};

class DeadZoneLaw final : public Effect {
 public:
  DeadZoneLaw()
      : Effect({.name = "dead_zone",
                .family = Family::kDrive,
                .kind = Kind::kDriveGain,
                .site = SiteKind::kActuator,
                .variable = LawVariable::kInput,
                .parameters = {NotNegative("width", Role::kGap, "N")},
                .meaning = "the drive gives nothing within +-width"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel&, const Channels&, int actuator,
                                         const EffectValues& values) const override {
    return std::make_unique<Deaf>(actuator, values[0]);
  }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(k.FrictionForce());
  }
};

class SpeedSofteningLaw final : public JointForceEffect {
 public:
  SpeedSofteningLaw()
      : JointForceEffect(
            {.name = "speed_softening",
             .family = Family::kStructure,
             .kind = Kind::kCompliance,
             .variable = LawVariable::kPosition,
             .parameters = {NotNegative("stiffness", Role::kAmplitude, "N/m"),
                            Positive("velocity", Role::kVelocity, "m/s")},
             .meaning = "-stiffness q / (1 + (v / velocity)^2)"}) {}

  double Force(double q, double v, double,
               const EffectValues& values) const noexcept override {
    const double ratio = v / values[1];
    return -values[0] * q / (1.0 + ratio * ratio);
  }
  // Of two variables.
  std::optional<double> Law(double, const EffectValues&) const override {
    return std::nullopt;
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double velocity = k.speed * r.Uniform(0.1, 0.5);
    return [=, stiffness = k.FrictionForce() / k.stroke](double s) {
      return ValuesOf({s * stiffness, velocity});
    };
  }
};

class Gyroscope final : public ActiveEffect {
 public:
  Gyroscope(const JointOf& joint, double coefficient)
      : joint_(joint), coefficient_(coefficient) {}
  void Push(const mjModel& model, mjData& data) noexcept override {
    const double q = data.qpos[joint_.position] - joint_.rest;
    for (int motor = 0; motor < model.nu; ++motor) {
      if (data.actuator_moment[motor * model.nv + joint_.dof] != 0.0) continue;
      data.qfrc_applied[joint_.dof] += coefficient_ * q * data.actuator_velocity[motor];
      return;
    }
  }

 private:
  JointOf joint_;
  double coefficient_;
};

class GyroscopicCouplingLaw final : public Effect {
 public:
  GyroscopicCouplingLaw()
      : Effect({.name = "gyroscopic_coupling",
                .family = Family::kStructure,
                .kind = Kind::kCoupling,
                .variable = LawVariable::kPosition,
                .parameters = {Free("coefficient", Role::kAmplitude, "N s/m^2")},
                .meaning = "coefficient q w, w the speed of another joint's motor"}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int joint,
                                         const EffectValues& values) const override {
    return std::make_unique<Gyroscope>(JointOf(model, joint), values[0]);
  }
  /// Joints that some motor leaves alone.
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    std::vector<Eigen::Index> joints = map.driven();
    std::erase_if(joints, [&](Eigen::Index joint) {
      return (map.model().Gamma.row(joint).array() != 0.0).all();
    });
    return map.Joints(joints);
  }
  Sized Draw(const Scales& k, Random& r) const override {
    return Proportional(r.Sign() * k.FrictionForce() / (k.stroke * k.speed));
  }
};

}  // namespace

const Effect& DeadZone() {
  static const DeadZoneLaw law;
  return law;
}

const Effect& SpeedSoftening() {
  static const SpeedSofteningLaw law;
  return law;
}

const Effect& GyroscopicCoupling() {
  static const GyroscopicCouplingLaw law;
  return law;
}

const std::vector<const Effect*>& OutsideLaws() {
  static const std::vector<const Effect*> laws{
      &RateAndStateFriction(), &RootFriction(), &ReversalFriction(),
      &PeriodicDamping(),      &DeadZone(),     &SpeedSoftening(),
      &GyroscopicCoupling()};
  return laws;
}

}  // namespace mjdiag
