// What a transmission gives under its motor's force, where the encoder sits on the motor's
// side: y + compliance F. It is what a mode does far below its resonance, which a tick of the
// control need not resolve.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "mjdiag/plugin/effects/encoder/reading_error.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/effects/wave.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// The joint whose position a sensor reads; -1: none.
int JointReadBy(const mjModel& model, int sensor) {
  return model.sensor_type[sensor] == mjSENS_JOINTPOS ? model.sensor_objid[sensor] : -1;
}

class WoundReading final : public RememberingEffect<WoundReading> {
 public:
  WoundReading(std::vector<std::size_t> channels, int dof, double compliance)
      : channels_(std::move(channels)), dof_(dof), compliance_(compliance) {}
  void Distort(const mjModel&, const mjData&, std::span<double> readings,
               double) noexcept override {
    for (const std::size_t i : channels_) readings[i] += compliance_ * force_;
  }
  // Of the last step before a reading, when its commands are known.
  void Bind(const mjModel& model, mjData& data) noexcept override {
    force_ = 0.0;
    for (int motor = 0; motor < model.nu; ++motor) {
      const double arm = data.actuator_moment[motor * model.nv + dof_];
      if (arm != 0.0) force_ += arm * MotorForce(model, data, motor);
    }
  }

 private:
  std::vector<std::size_t> channels_;
  int dof_;
  double compliance_;
  double force_ = 0.0;
};

class TransmissionWindupEffect final : public Effect {
 public:
  TransmissionWindupEffect()
      : Effect({.name = "transmission_windup",
                .family = Family::kEncoder,
                .kind = Kind::kCompliance,
                .site = SiteKind::kSensor,
                .variable = LawVariable::kInput,
                .parameters = {NotNegative("compliance", Role::kAmplitude, "m/N")},
                .meaning =
                    "the encoder of a joint is at its motor, behind a transmission "
                    "that gives by compliance times the motor's force",
                .odds = kSome}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels& channels,
                                         int element,
                                         const EffectValues& values) const override {
    const int joint = JointReadBy(model, element);
    if (joint < 0) {
      throw InputError(Where(*this, ElementName(model, mjOBJ_SENSOR, element)),
                       "its sensor reads no joint", "a <jointpos>");
    }
    return std::make_unique<WoundReading>(ChannelsOf(model, channels, element),
                                          model.jnt_dofadr[joint], values[0]);
  }
  std::vector<Site> CandidateSites(const SiteMap& map) const override {
    std::vector<Site> sites = map.Sensors();
    std::erase_if(sites, [&](const Site& site) {
      const int sensor = FindElement(map.plant(), mjOBJ_SENSOR, site.name);
      return JointReadBy(map.plant(), sensor) < 0 ||
             (map.model().Gamma.row(site.joint).array() == 0.0).all();
    });
    return sites;
  }
  // A tick's command acts behind its reading.
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    return {LinearRegressor(Delayed(at.motor()), {}, 0.0, true)};
  }
  // Belts, screws and gears carry what they move at some tens of hertz.
  EffectValues Spread(const Scales& k) const override { return ValuesOf({Typical(k)}); }
  Sized Draw(const Scales& k, Random&) const override {
    return Proportional(Typical(k));
  }

 private:
  static double Typical(const Scales& k) {
    constexpr double kFrequency = 20.0;  // [Hz]
    return 1.0 / (k.mass * std::pow(kTurn * kFrequency, 2));
  }
};

}  // namespace

const Effect& TransmissionWindup() {
  static const TransmissionWindupEffect effect;
  return effect;
}

}  // namespace mjdiag
