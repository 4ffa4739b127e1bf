#pragma once
// Numbers of a plant (model_parameter.h) put into its model: what loading an MJCF gives in
// which they are other ones.

#include <mujoco/mujoco.h>

#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

/// Multiplies it, or shifts it if it is additive. Numbers that MuJoCo derives constants
/// from (IsDerivedFrom) ask for DeriveConstants afterwards. Does not allocate.
void Scale(mjModel& model, const ModelParameter& number, double factor) noexcept;
/// Scales them all, with what MuJoCo derives. Tendons whose springs rest at the length
/// that they have in the configuration of the springs do so with other references too.
void ScaleNumbers(mjModel& model, const NumberFactors& factors);
/// Makes it `factor` times what it is in `nominal`. Does not allocate.
void SetNumber(mjModel& model, const mjModel& nominal, const ModelParameter& number,
               double factor) noexcept;
/// What MuJoCo derives from masses, rotors and references.
void DeriveConstants(mjModel& model);

/// Whether its element has such a number at all, be it 0.
bool HasNumber(const mjModel& model, const ModelParameter& number);
/// By how far one that is additive moves with the logarithm of its factor [m, rad].
double UnitOf(const mjModel& model, const ModelParameter& number);
/// That unit, "m" or "rad".
const char* UnitName(const mjModel& model, const ModelParameter& number);
/// In SI units: where there are several, of an inertia or a gear, the largest in magnitude,
/// with which the others go.
double ValueOf(const mjModel& model, const ModelParameter& number);
/// The factor that makes it that value. InputError if none does, as of a number that is 0.
double FactorFor(const mjModel& model, const ModelParameter& number, double value);

}  // namespace mjdiag
