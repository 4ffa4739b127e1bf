#pragma once
// The numbers of a plant that nobody knows exactly (model_parameter_kind.h), by element, and
// how well they are known.
//
// A plant says how well one is known by a relative standard deviation of its own,
//   <custom><numeric name="known.stiffness@X" data="0.02"/></custom>
// or of a whole kind, `known.mass`, or of all that have none, `known` (0: a plant that is
// what it says, as a simulated one). Without either it is known as its kind usually is (UsualSpread).

#include <mujoco/mujoco.h>

#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/plant/model_parameter_kind.h"

namespace mjdiag {

struct ModelParameter {
  ModelParameterKind kind = ModelParameterKind::kMass;
  int element = 0;  ///< id of the body, joint, actuator or tendon

  bool operator==(const ModelParameter&) const = default;
};

/// Numbers of a plant with the factors that multiply them.
using NumberFactors = std::vector<std::pair<ModelParameter, double>>;

/// "stiffness@X".
std::string ModelParameterName(const mjModel& model, const ModelParameter& number);
/// Of that name. InputError on an unknown kind or element, and on a number that the element
/// has none of: the gain of an actuator without a bias, the reference of a ball joint.
ModelParameter FindModelParameter(const mjModel& model, const std::string& name);

/// All that are not 0, of bodies that move; no two that do the same: of an actuator that
/// feeds back its position kp and kv, of another with a bias by its velocity gain. Without
/// those that are additive, but for a reference that the plant says how well it is known.
std::vector<ModelParameter> ModelParameters(const mjModel& model);
/// Centres of mass of all bodies that move: what a machine that leaves its rest shows.
std::vector<ModelParameter> CentreNumbers(const mjModel& model);
/// Those that a text means: "all", without references, a kind ("mass") or one
/// ("mass@stage"). InputError if it means none.
std::vector<ModelParameter> ModelParametersOf(const mjModel& model,
                                              const std::string& text);

/// As the plant declares it, else UsualSpread. InputError on a declaration that is not a
/// number >= 0.
double SpreadOf(const mjModel& model, const ModelParameter& number);
/// Standard deviation of the logarithm of a number that nobody has measured on the
/// machine itself, when a record of it is explained: as the plant declares it above 0,
/// else UsualDoubt.
double DoubtOf(const mjModel& model, const ModelParameter& number);
/// Whether the plant says of itself that it is what it says (`known` 0).
bool IsExact(const mjModel& model);
/// InputError on a `known.` of the plant that names no number of it.
void CheckKnownNumbers(const mjModel& model);

}  // namespace mjdiag
