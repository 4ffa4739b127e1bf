#pragma once
// Effects: physics that a plant lacks, put in at a site (a joint, actuator or sensor,
// by its MJCF name). On the command line:   coulomb_friction@load:force=20.4 In an MJCF
// file:  <custom><numeric name="effect.force_offset.load" data="3.2"/></custom> with
// the parameters in the order of the catalogue.
//
// What MuJoCo has natively is put into the mjModel; the rest acts as a force in every
// physics step (force_effect.h).

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mjdiag {

struct EffectParameter {
  std::string name;
  std::string unit;  ///< of a slide; a hinge has N m for N and rad for m
  double minimum = 0.0;
  double maximum = 0.0;
};

/// One entry of the catalogue.
struct EffectType {
  std::string name;
  mjtObj site = mjOBJ_JOINT;  ///< what kind of element it acts at
  bool native = false;        ///< realised by attributes of the mjModel
  std::vector<EffectParameter> parameters;
  std::string meaning;
};

/// An effect at a site with values for all its parameters.
struct EffectSpec {
  std::string effect;
  std::string site;
  std::map<std::string, double> parameters;
};

/// All effects this version knows.
const std::vector<EffectType>& EffectCatalogue();
/// The entry of that name; InputError lists the known ones.
const EffectType& FindEffect(std::string_view name);

/// Parses "<effect>@<site>:<name>=<value>,..."; InputError says what is malformed.
EffectSpec ParseEffect(std::string_view text);

/// The effects that an MJCF file carries itself, under <custom>.
std::vector<EffectSpec> EffectsOf(const mjModel& model);

/// InputError on an unknown effect, site or parameter, a missing parameter or a value
/// out of bounds. @return the id of the site's element
int CheckEffect(const mjModel& model, const EffectSpec& effect);

/// Puts a native effect into the model (after CheckEffect); others leave it as it is.
void ApplyNativeEffect(mjModel& model, const EffectSpec& effect);

}  // namespace mjdiag
