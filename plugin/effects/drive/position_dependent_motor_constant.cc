// The motor constant over the travel s of the motor since qpos0:
//   u <- u max(0, 1 + slope s + curvature s^2)
// A motor gives less force at the end of its magnets, but never turns round.

#include <algorithm>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

class VaryingMotor final : public ActiveEffect {
 public:
  VaryingMotor(const mjModel& model, int actuator, const EffectValues& values)
      : slope_(values[0]),
        curvature_(values[1]),
        gear_(std::max(GearOf(model, actuator), mjMINVAL)),
        actuator_(actuator) {
    const DataPtr data = MakeData(model);
    mj_fwdPosition(&model, data.get());
    rest_ = data->actuator_length[actuator];
  }
  void Drive(const mjModel&, mjData& data) noexcept override {
    const double s = (data.actuator_length[actuator_] - rest_) / gear_;
    data.ctrl[actuator_] *= std::max(0.0, 1.0 + slope_ * s + curvature_ * s * s);
  }

 private:
  double slope_;
  double curvature_;
  double gear_;  // length of a unit of travel in the actuator's own length
  double rest_ = 0.0;
  int actuator_;
};

class PositionDependentMotorConstantEffect final : public Effect {
 public:
  PositionDependentMotorConstantEffect()
      : Effect({.name = "position_dependent_motor_constant",
                .family = Family::kDrive,
                .kind = Kind::kDriveGain,
                .site = SiteKind::kActuator,
                .variable = LawVariable::kPosition,
                .parameters = {Free("slope", Role::kAmplitude, "1/m"),
                               Free("curvature", Role::kAmplitude, "1/m^2")},
                .meaning = "the force times 1 + slope s + curvature s^2, s the travel "
                           "of the motor",
                .odds = kRare}) {}

  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels&,
                                         int actuator,
                                         const EffectValues& values) const override {
    return std::make_unique<VaryingMotor>(model, actuator, values);
  }
  std::vector<CandidateRegressor> CandidateRegressors(
      const SiteMotion& at) const override {
    const Eigen::VectorXd q = at.q();
    Eigen::MatrixXd parts(q.size(), 2);
    parts << q.cwiseProduct(at.u()), q.cwiseAbs2().cwiseProduct(at.u());
    return {LinearRegressor(parts, at.MotorEntry(2))};
  }
  // A tenth over the stroke, thrice that at the most.
  EffectValues Spread(const Scales& k) const override {
    return ValuesOf({0.3 / k.stroke, 0.3 / (k.stroke * k.stroke)});
  }
  Sized Draw(const Scales& k, Random& r) const override {
    const double slope = r.Sign() * r.Uniform(0.2, 1.0) * 0.1 / k.stroke;
    const double curvature =
        r.Sign() * r.Uniform(0.2, 1.0) * 0.1 / (k.stroke * k.stroke);
    return [=](double s) { return ValuesOf({s * slope, s * curvature}); };
  }
};

}  // namespace

const Effect& PositionDependentMotorConstant() {
  static const PositionDependentMotorConstantEffect effect;
  return effect;
}

}  // namespace mjdiag
