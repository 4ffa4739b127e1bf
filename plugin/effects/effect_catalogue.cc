#include <limits>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr double kFullTurn = 6.283185307179587;

EffectParameter Free(std::string name, std::string unit) {
  return {std::move(name), std::move(unit), -kAny, kAny};
}
EffectParameter NotNegative(std::string name, std::string unit) {
  return {std::move(name), std::move(unit), 0.0, kAny};
}
EffectParameter Positive(std::string name, std::string unit) {
  return {std::move(name), std::move(unit), std::numeric_limits<double>::min(), kAny};
}
EffectParameter Phase() { return {"phase", "rad", -kFullTurn, kFullTurn, 0.0}; }

std::vector<EffectType> FrictionTypes() {
  using enum EffectSite;
  return {
      {"coulomb_friction",
       kJoint,
       true,
       {NotNegative("force", "N")},
       "dry friction: -force sign(v), sticking at rest"},
      {"stribeck_friction",
       kJoint,
       false,
       {NotNegative("coulomb", "N"), NotNegative("breakaway", "N"),
        Positive("velocity", "m/s")},
       "dry friction of coulomb + breakaway exp(-(v / velocity)^2)"},
      {"viscous_friction",
       kJoint,
       true,
       {Free("coefficient", "N s/m")},
       "-coefficient v"},
      {"asymmetric_viscous_friction",
       kJoint,
       false,
       {Free("positive", "N s/m"), Free("negative", "N s/m")},
       "-positive v for v > 0, -negative v for v < 0"},
      {"quadratic_drag",
       kJoint,
       false,
       {Free("coefficient", "N s^2/m^2")},
       "-coefficient v |v|"},
      {"presliding_hysteresis",
       kJoint,
       false,
       {NotNegative("force", "N"), Positive("stiffness", "N/m")},
       "Dahl friction: springs with that stiffness before it slides"},
      {"hysteretic_stiffness",
       kJoint,
       false,
       {NotNegative("stiffness", "N/m"), NotNegative("loss", "1"),
        Positive("length", "m")},
       "-stiffness (q + loss z), z follows q over that length: a cable, a hose"},
  };
}

std::vector<EffectType> DriveTypes() {
  using enum EffectSite;
  return {
      {"force_offset", kJoint, false, {Free("force", "N")}, "a constant force"},
      {"force_ripple",
       kJoint,
       false,
       {Free("amplitude", "N"), Positive("period", "m"), Phase()},
       "amplitude sin(2 pi q / period + phase): cogging"},
      {"motor_constant",
       kActuator,
       true,
       {NotNegative("factor", "1")},
       "the force of the motor times factor"},
      {"position_dependent_motor_constant",
       kActuator,
       false,
       {Free("slope", "1/m"), Free("curvature", "1/m^2")},
       "the force times 1 + slope s + curvature s^2, s the travel of the motor"},
      {"force_saturation",
       kActuator,
       true,
       {Positive("limit", "of u")},
       "the drive gives no more than that"},
      {"input_delay",
       kActuator,
       false,
       {{"delay", "s", 0.0, 0.1}},
       "the drive follows its command that much later"},
      {"amplifier_lag",
       kActuator,
       false,
       {Positive("time_constant", "s")},
       "the drive follows its command as a first-order low-pass"},
  };
}

std::vector<EffectType> StructureTypes() {
  using enum EffectSite;
  return {
      {"linear_stiffness",
       kJoint,
       true,
       {Free("stiffness", "N/m")},
       "-stiffness q on a joint without a spring, a second spring on one with"},
      {"cubic_stiffness",
       kJoint,
       false,
       {Free("coefficient", "N/m^3")},
       "-coefficient q^3"},
      {"structural_stiffness",
       kHeldJoint,
       true,
       {NotNegative("factor", "1")},
       "the stiffness of a joint that has one, times factor"},
      {"added_mass",
       kJoint,
       true,
       {Free("mass", "kg")},
       "mass at the centre of the moving body; inertia about a hinge"},
      {"flexible_mode",
       kJoint,
       false,
       {NotNegative("mass", "kg"), Positive("frequency", "Hz"),
        NotNegative("damping_ratio", "1")},
       "a mass on a spring and a damper on the joint"},
      {"backlash",
       kHeldJoint,
       false,
       {NotNegative("gap", "m")},
       "play of that full width in what holds the joint"},
      {"end_stop",
       kJoint,
       false,
       {Free("position", "m"), NotNegative("stiffness", "N/m")},
       "a spring beyond position, on the side of its sign"},
      {"floor_vibration",
       kJoint,
       false,
       {Free("amplitude", "N"), Positive("frequency", "Hz"), Phase()},
       "amplitude sin(2 pi frequency t + phase): what the floor passes on"},
  };
}

std::vector<EffectType> EncoderTypes() {
  using enum EffectSite;
  return {
      {"encoder_scale",
       kSensor,
       false,
       {Free("factor", "1")},
       "the reading times factor"},
      {"encoder_periodic_error",
       kSensor,
       false,
       {Free("amplitude", "m"), Positive("period", "m"), Phase()},
       "the reading plus amplitude sin(2 pi reading / period + phase)"},
      {"encoder_drift",
       kSensor,
       false,
       {Free("rate", "m/s")},
       "the reading plus rate t"},
      {"encoder_noise",
       kSensor,
       false,
       {NotNegative("sd", "m")},
       "white noise of that standard deviation, beside the sensor's own"},
  };
}

}  // namespace

mjtObj EffectType::element() const {
  switch (site) {
    case EffectSite::kActuator:
      return mjOBJ_ACTUATOR;
    case EffectSite::kSensor:
      return mjOBJ_SENSOR;
    default:
      return mjOBJ_JOINT;
  }
}

const std::vector<EffectType>& EffectCatalogue() {
  static const std::vector<EffectType> catalogue = [] {
    std::vector<EffectType> all;
    for (auto* family : {FrictionTypes, DriveTypes, StructureTypes, EncoderTypes}) {
      for (EffectType& type : family()) all.push_back(std::move(type));
    }
    return all;
  }();
  return catalogue;
}

const EffectType& FindEffect(std::string_view name) {
  std::string known;
  for (const EffectType& type : EffectCatalogue()) {
    if (type.name == name) return type;
    known += (known.empty() ? "" : ", ") + type.name;
  }
  throw InputError("effect", "unknown effect '" + std::string(name) + "'",
                   "one of " + known);
}

}  // namespace mjdiag
