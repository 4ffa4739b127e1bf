#pragma once
// Every effect but noise at a site of each machine of mjcf/, large enough to move it:
// those of the list, and any other as a benchmark would draw it.

#include <algorithm>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag::test {

/// Adds the effects that are not listed at the sites that make sense to them.
inline std::vector<std::string> WithDrawn(std::vector<std::string> effects,
                                          const Scales& scales,
                                          const std::vector<std::string>& sites) {
  for (const Effect* effect : Effects()) {
    const auto is_listed = [&](const std::string& text) {
      return text.starts_with(effect->name() + "@");
    };
    const std::string& site = sites.at(static_cast<std::size_t>(effect->site()));
    if (effect->form() == Form::kNoise || site.empty()) continue;
    if (std::ranges::any_of(effects, is_listed)) continue;
    Random random(1);
    effects.push_back(
        FormatEffect({Lasting(*effect), site, effect->Draw(scales, random)(1.0)}));
  }
  return effects;
}

inline const std::vector<std::string>& EveryEffectOfAb383() {
  static const std::vector<std::string> effects = WithDrawn(
      {"coulomb_friction@X:force=1.3",
       "stribeck_friction@Y:coulomb=0.7,breakaway=0.9,velocity=0.013",
       "viscous_friction@X:coefficient=7.1",
       "asymmetric_viscous_friction@Y:positive=3.3,negative=-1.1",
       "quadratic_drag@X:coefficient=11.7",
       "presliding_hysteresis@Y:force=1.1,stiffness=230000",
       "hysteretic_stiffness@X:stiffness=170,loss=0.3,length=0.0011",
       "force_offset@Z:force=0.0031",
       "force_ripple@Y:amplitude=0.7,period=0.0241,phase=0.3",
       "motor_constant@x_motor:factor=0.971",
       "position_dependent_motor_constant@y_motor:slope=1.7,curvature=-31.3",
       "force_saturation@x_motor:limit=207.3",
       "input_delay@x_motor:delay=1.37e-4",
       "amplifier_lag@z_motor:time_constant=7.3e-5",
       "linear_stiffness@Y:stiffness=313.7",
       "linear_stiffness@Z:stiffness=-0.217",
       "cubic_stiffness@X:coefficient=1.1e7",
       "structural_stiffness@r2:factor=0.83",
       "added_mass@Y:mass=0.0371",
       "added_mass@Z:mass=3.1e-6",
       "flexible_mode@X:mass=0.13,frequency=171.3,damping_ratio=0.017",
       "backlash@u3:gap=1.3e-8",
       "end_stop@X:position=0.0017,stiffness=1.3e5",
       "floor_vibration@u1:amplitude=9.1,frequency=33.3,phase=0.7",
       "encoder_scale@x_encoder:factor=1.00013",
       "encoder_periodic_error@y_encoder:amplitude=3.1e-8,period=2e-5",
       "encoder_drift@z_encoder:rate=1.7e-5",
       "encoder_delay@y_encoder:delay=1.3e-5",
       "transmission_windup@z_encoder:compliance=1.3e-4"},
      {.stroke = 4e-3, .speed = 0.3, .force = 250.0, .mass = 1.0, .duration = 1.0},
      {"X", "r2", "x_motor", "x_encoder", "Z"});
  return effects;
}

inline std::vector<std::string> Without(std::vector<std::string> effects,
                                        const std::string& name) {
  std::erase_if(effects,
                [&](const auto& text) { return text.starts_with(name + "@"); });
  return effects;
}

inline const std::vector<std::string>& EveryEffectOfEmps() {
  // Its motor has no other to be coupled to.
  static const std::vector<std::string> effects = Without(
      WithDrawn(
          {"coulomb_friction@load:force=20.3",
           "stribeck_friction@load:coulomb=13.1,breakaway=7.7,velocity=0.0013",
           "viscous_friction@load:coefficient=-17.3",
           "asymmetric_viscous_friction@load:positive=13.3,negative=-7.1",
           "position_dependent_friction@load:slope=313.7,curvature=117.1",
           "quadratic_drag@load:coefficient=31.7",
           "presliding_hysteresis@load:force=7.1,stiffness=230000",
           "hysteretic_stiffness@load:stiffness=1700,loss=0.3,length=0.0011",
           "force_offset@load:force=-3.1648",
           "force_ripple@load:amplitude=1.7,period=0.0241,phase=0.3",
           "motor_constant@drive:factor=0.971",
           "position_dependent_motor_constant@drive:slope=0.37,curvature=-1.3",
           "force_saturation@drive:limit=1.3",
           "input_delay@drive:delay=1.37e-3",
           "amplifier_lag@drive:time_constant=7.3e-4",
           "linear_stiffness@load:stiffness=313.7",
           "cubic_stiffness@load:coefficient=1.1e4",
           "added_mass@load:mass=-1.71",
           "flexible_mode@load:mass=3.1,frequency=31.3,damping_ratio=0.017",
           "end_stop@load:position=0.0017,stiffness=1.3e4",
           "floor_vibration@load:amplitude=3.1,frequency=33.3,phase=0.7",
           "encoder_scale@load_encoder:factor=1.00013",
           "encoder_periodic_error@load_encoder:amplitude=3.1e-6,period=2e-3",
           "encoder_drift@load_encoder:rate=1.7e-5",
           "encoder_delay@load_encoder:delay=1.3e-4",
           "transmission_windup@load_encoder:compliance=1.3e-6"},
          {.stroke = 0.2, .speed = 0.2, .force = 2.0, .mass = 95.0, .duration = 1.0},
          // Nothing in EMPS is held by a spring, and nothing turns.
          {"load", "", "drive", "load_encoder", ""}),
      "force_coupling");
  return effects;
}

}  // namespace mjdiag::test
