#pragma once
// An effect: physics that a plant lacks, put in at a site (a joint, actuator or sensor,
// by its MJCF name). One class an effect, in a file of its own, knows everything about
// it; the rest of the program knows only this base class and the list of all of them
// (registry.h). Effects are stateless descriptions: the values of their parameters are
// passed in, in the order in which `parameters` has them.
//
// The fault parameters that a plant declares are effects as well (fault_effect.h).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <array>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/plugin/effects/placed_effect.h"
#include "mjdiag/plugin/effects/role.h"
#include "mjdiag/plugin/effects/site.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct EffectParameter {
  std::string name;
  Role role;
  std::string unit;  ///< of a slide; see SiteUnit for what turns
  double minimum;
  double maximum;
  std::optional<double> fallback{};  ///< the value if none is given; none: required
  /// The most that is named: what has more of it is other physics.
  double plausible = std::numeric_limits<double>::infinity();
};

/// What an effect can act at.
enum class SiteKind {
  kJoint,      ///< any slide or hinge
  kHeldJoint,  ///< one with a spring
  kActuator,
  kSensor,
  kHinge  ///< any hinge
};

/// What kind of physics an effect is; the effects of each lie in a folder of that name.
enum class Family { kFriction, kDrive, kStructure, kEncoder };
inline constexpr std::array kFamilies = {Family::kFriction, Family::kDrive,
                                         Family::kStructure, Family::kEncoder};
/// "friction".
std::string FamilyName(Family family);

/// How an extended plant carries an effect.
enum class Form {
  kAttributes,  ///< attributes of MJCF elements: a native effect
  kNumeric,     ///< <custom><numeric>, which mjdiag turns into forces
  kNoise        ///< noise of the sensor in the setup
};

/// What the force of an effect is drawn over, for people.
enum class LawVariable { kPosition, kVelocity, kAcceleration, kInput, kTime };

/// Values of an effect's parameters, in their order.
using EffectValues = Eigen::VectorXd;
inline constexpr double kAnySize = std::numeric_limits<double>::infinity();
EffectValues ValuesOf(std::initializer_list<double> values);

/// How often an effect is what a simulation lacks, beside dry friction: what nearly every
/// machine has, what some have, and what one has now and then.
inline constexpr double kCommon = 1.0;
inline constexpr double kSome = 0.3;
inline constexpr double kRare = 0.1;
/// What is never looked for, but made of another, or of what nothing else explains.
inline constexpr double kLearned = 0.03;

/// What is said of every effect.
struct EffectType {
  std::string name;
  Family family;
  Kind kind;
  SiteKind site = SiteKind::kJoint;
  Form form = Form::kNumeric;
  LawVariable variable;
  std::vector<EffectParameter> parameters;
  std::string meaning;
  double odds = kCommon;  ///< Effect::odds
};

class Effect {
 public:
  explicit Effect(EffectType type) : type_(std::move(type)) {}
  virtual ~Effect() = default;
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;

  const std::string& name() const { return type_.name; }
  const std::string& meaning() const { return type_.meaning; }
  const std::vector<EffectParameter>& parameters() const { return type_.parameters; }
  Family family() const { return type_.family; }
  Kind kind() const { return type_.kind; }
  SiteKind site() const { return type_.site; }
  Form form() const { return type_.form; }
  LawVariable variable() const { return type_.variable; }
  /// What kind of element the site is.
  mjtObj element() const;
  /// Place of the parameter with that name, or of the first with that role.
  std::optional<Eigen::Index> Find(std::string_view parameter) const;
  std::optional<Eigen::Index> Find(Role role) const;
  /// Parameters of the plant itself, which it declares, are faults.
  virtual bool IsFault() const { return false; }

  // What it does to a machine.

  /// Puts into the model what MuJoCo has natively of it; `element` is the site's.
  /// InputError if it takes away more mass or damping than there is.
  virtual void Apply(mjModel&, int /*element*/, const EffectValues&) const {}
  /// Takes out again what Apply has put in, of effects that a plant carries as
  /// numerics.
  virtual void Retract(mjModel&, int /*element*/, const EffectValues&) const {}
  /// What it does in a step, a tick or a reading; null if nothing.
  virtual std::unique_ptr<ActiveEffect> Activate(const mjModel&, const Channels&,
                                                 int /*element*/,
                                                 const EffectValues&) const;
  /// The noise of a sensor at the site that has `sd` by itself.
  virtual double NoiseSd(double sd, const EffectValues&) const { return sd; }

  // How it is found.

  /// The sites at which it may be what a simulation lacks: by default the joints that
  /// an actuator moves, those that a spring holds, the actuators or the sensors.
  virtual std::vector<Site> CandidateSites(const SiteMap& map) const;
  /// What the plant has to be left with: the least value of a parameter that can be
  /// put in at a joint (nq index).
  virtual double Least(const mjModel& plant, Eigen::Index joint,
                       std::size_t parameter) const;
  /// CandidateRegressors on a small grid along a motion; none of an effect with a sweep.
  virtual std::vector<CandidateRegressor> CandidateRegressors(const SiteMotion&) const {
    return {};
  }
  /// @param duration  of what is fitted [s], for the resolution of frequencies
  virtual std::optional<ParameterScan> MakeParameterScan(const SiteMotion&,
                                                         double /*duration*/) const;

  // How likely it is.

  /// How often it is what a simulation lacks, beside dry friction.
  double odds() const { return type_.odds; }
  /// How large its amplitudes and factors are on machines: standard deviations about
  /// nothing (0 of an amplitude, 1 of a factor), infinite where any size is as good. By
  /// default the machine's own size in their unit (MachineUnit): friction as large as
  /// the motor is rare, a multiple of it is no friction.
  virtual EffectValues Spread(const Scales& scales) const;

  /// How many times what it would a sensor reads with it: by so much less an observer pulls.
  virtual double ReadingScale(const EffectValues&) const { return 1.0; }

  // How it compares with others.

  /// The law that this one becomes at an end of its parameters, at the same site, with
  /// values to start from.
  virtual std::optional<PlacedEffect> Simpler(const PlacedEffect&) const;
  /// The effect that changes the very same attribute of the model and nothing else, so
  /// that no measurement tells them apart; null without one.
  virtual const Effect* Twin() const { return nullptr; }
  /// The values of the twin that are the same change of the plant, and back; none if
  /// there are none.
  virtual EffectValues ToTwin(const mjModel&, const EffectValues& values) const {
    return values;
  }
  virtual std::optional<EffectValues> FromTwin(const mjModel&,
                                               const EffectValues& twin) const {
    return twin;
  }

  /// The number of the plant at that element that a part of it adds to, or that it
  /// scales: no record tells the two apart, and with it the number is what the plant
  /// says.
  virtual std::optional<ModelParameter> Number(const mjModel&, int /*element*/) const {
    return std::nullopt;
  }

  // How it is shown and drawn.

  /// The force over its variable, if it is a function of that alone.
  virtual std::optional<double> Law(double x, const EffectValues&) const;
  /// Shape at random, in the units of what a machine has.
  virtual Sized Draw(const Scales&, Random&) const = 0;

 protected:
  // Parameters without bounds, of at least 0 and above 0.
  static EffectParameter Free(std::string name, Role role, std::string unit);
  static EffectParameter NotNegative(std::string name, Role role, std::string unit);
  static EffectParameter Positive(std::string name, Role role, std::string unit);
  /// The phase of a wave, 0 unless it is given.
  static EffectParameter Phase();

 private:
  EffectType type_;
};

/// A pointer to an effect that is there for good.
inline EffectPtr Lasting(const Effect& effect) { return {EffectPtr(), &effect}; }

/// Effect::Number at the element of that name; none if there is no such element.
std::optional<ModelParameter> NumberAt(const Effect& effect, const mjModel& plant,
                                       const std::string& site);

/// "effect <name>@<site>", where messages begin.
std::string Where(const Effect& effect, const std::string& site);
/// InputError: takes away more `what` than there is.
[[noreturn]] void FailTooMuch(const Effect& effect, const mjModel& model, int element,
                              const char* what);

}  // namespace mjdiag
