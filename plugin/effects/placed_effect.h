#pragma once
// Effects as people write them. On the command line:
//   coulomb_friction@load:force=20.4
// and in an MJCF file
//   <custom><numeric name="effect.force_offset.load" data="3.2"/></custom>
// with all parameters in their order, once for each such effect at the site.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mjdiag {

struct EffectParameter;
class Effect;
/// Owns effects that are made from a plant; registered ones are there for good.
using EffectPtr = std::shared_ptr<const Effect>;

/// An effect at a site with values for its parameters.
struct PlacedEffect {
  EffectPtr effect;
  std::string site;
  Eigen::VectorXd values;

  const std::string& name() const;
  /// Of the parameter with that name, which the effect has.
  double Value(std::string_view parameter) const;

  bool operator==(const PlacedEffect& other) const;
};

/// True if both are the same effect at the same site.
bool SameKind(const PlacedEffect& a, const PlacedEffect& b);

/// A registered effect with values by name; parameters that are not given have their
/// fallback. InputError on an unknown effect or parameter, one that is missing, or a
/// value out of bounds.
PlacedEffect Place(std::string_view effect, std::string site,
                   const std::map<std::string, double>& values);

/// The same from "<effect>@<site>:<name>=<value>,..."; InputError says what is
/// malformed.
PlacedEffect ParseEffect(std::string_view text);
/// That form again, with all digits.
std::string FormatEffect(const PlacedEffect& effect);
/// Values by name.
std::map<std::string, double> NamedValues(const PlacedEffect& effect);

/// The effects that an MJCF file carries itself, under <custom>.
std::vector<PlacedEffect> EffectsOf(const mjModel& model);

/// InputError on an unknown site, a value out of bounds, or a site at which the effect
/// means nothing. @return the id of the site's element
int CheckEffect(const mjModel& model, const PlacedEffect& effect);

/// Puts what MuJoCo has natively of an effect into the model, after CheckEffect.
void ApplyEffect(mjModel& model, const PlacedEffect& effect);

/// The unit of a parameter: as in the registry for a slide; at a hinge, and at an encoder that
/// reads hinges, N becomes N m, m becomes rad and kg becomes kg m^2.
std::string SiteUnit(const mjModel& model, const Effect& effect,
                     const std::string& site, const EffectParameter& parameter);

}  // namespace mjdiag
