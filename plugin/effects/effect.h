#pragma once
// Effects: physics that a plant lacks, put in at a site (a joint, actuator or sensor,
// by its MJCF name). On the command line:   coulomb_friction@load:force=20.4 In an MJCF
// file:  <custom><numeric name="effect.force_offset.load" data="3.2"/></custom> with
// the parameters in the order of the catalogue, once for each such effect at the site.
//
// What MuJoCo has natively is put into the mjModel (native_effect.h); the rest acts in
// every physics step (active_effect.h).

#include <mujoco/mujoco.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mjdiag {

struct EffectParameter {
  std::string name;
  std::string unit;  ///< of a slide; see SiteUnit for a hinge
  double minimum = 0.0;
  double maximum = 0.0;
  std::optional<double> fallback{};  ///< the value if none is given; none: required
};

/// What an effect can act at.
enum class EffectSite {
  kJoint,      ///< any slide or hinge
  kHeldJoint,  ///< one with a spring
  kActuator,
  kSensor
};

/// One entry of the catalogue.
struct EffectType {
  std::string name;
  EffectSite site = EffectSite::kJoint;
  bool native = false;  ///< realised by attributes of the mjModel
  std::vector<EffectParameter> parameters;
  std::string meaning;

  /// What kind of element the site is.
  mjtObj element() const;
};

/// An effect at a site with values for its parameters.
struct EffectSpec {
  std::string effect;
  std::string site;
  std::map<std::string, double> parameters;

  /// A parameter that CheckEffect has passed, or its fallback.
  double Value(std::string_view parameter) const;

  bool operator==(const EffectSpec&) const = default;
};

/// All effects of design and documentation, in their order.
const std::vector<EffectType>& EffectCatalogue();
/// The entry of that name; InputError lists the known ones.
const EffectType& FindEffect(std::string_view name);

/// The unit of a parameter at a joint: as in the catalogue for a slide; for a hinge N
/// becomes N m, m becomes rad and kg becomes kg m^2. Other sites: as in the catalogue.
std::string SiteUnit(const mjModel& model, const EffectSpec& effect,
                     std::string_view parameter);

/// Parses "<effect>@<site>:<name>=<value>,..."; InputError says what is malformed.
EffectSpec ParseEffect(std::string_view text);
/// The same form again, with all digits.
std::string FormatEffect(const EffectSpec& effect);

/// The effects that an MJCF file carries itself, under <custom>.
std::vector<EffectSpec> EffectsOf(const mjModel& model);

/// InputError on an unknown effect, site or parameter, a missing parameter, a value out
/// of bounds, or a site at which the effect means nothing. @return the id of the
/// site's element
int CheckEffect(const mjModel& model, const EffectSpec& effect);

}  // namespace mjdiag
