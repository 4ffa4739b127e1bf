#pragma once
// Of what kinds the numbers of an MJCF are that nobody knows exactly, one table for all:
// their names, on what element they stand, what they mean, how well they are known.
//
//   mass@<body>, inertia@<body>              of it and what it weighs
//   stiffness@<joint>, damping@<joint>, friction@<joint>
//   armature@<joint>                         inertia of the rotor, behind its gears
//   gear@<actuator>                          force of a unit of its control
//   gain@<actuator>                          of one with a bias: gain and bias together,
//                                            1 / R of a DC motor driven by a voltage
//   kp@<actuator>                            of one that feeds back its position: the gain
//                                            with the bias by its length
//   kv@<actuator>                            the bias by its velocity alone
//   tendon_stiffness@<tendon>, tendon_damping@, tendon_friction@
//   centre_x@<body>, centre_y@, centre_z@    centre of mass along an axis of the body's
//                                            frame
//   ref@<joint>                              position in which it stands as drawn
//
// All are multiplied by a factor but the last two, which are additive: a factor f of one
// is a shift by ln f units. The unit of a centre of mass is the radius of gyration,
// sqrt(tr I / (2 m)): what is known of it goes by the size of the body, and whatever f is,
// the body stays one that there can be. That of a reference is 1 rad of a hinge, and of a
// slide the extent of the model.

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <string_view>

namespace mjdiag {

enum class ModelParameterKind {
  kMass,
  kInertia,
  kStiffness,
  kDamping,
  kFriction,
  kGear,
  kArmature,
  kGain,
  kCentreX,
  kCentreY,
  kCentreZ,
  kKp,
  kKv,
  kTendonStiffness,
  kTendonDamping,
  kTendonFriction,
  kRef
};

/// "stiffness".
std::string_view WordOf(ModelParameterKind kind);
/// None of a word that is no kind.
std::optional<ModelParameterKind> FindKind(std::string_view word);
/// What kind of element it is of.
mjtObj ElementOf(ModelParameterKind kind);
/// "dry friction", of a joint or a tendon.
std::string_view MeaningOf(ModelParameterKind kind);
/// All of them: "mass@ or inertia@ a body, stiffness@, ... a joint, ...". Without the
/// additive ones if those are no answer.
std::string AllKinds(bool additive = true);

/// A factor of it is a shift.
bool IsAdditive(ModelParameterKind kind);
/// Of a body's mass.
bool IsCentre(ModelParameterKind kind);
/// Dry friction, of a joint or a tendon: its force jumps, and it wears.
bool IsFriction(ModelParameterKind kind);
/// How much force an actuator makes of a control: gear, gain, kp, kv.
bool IsDrive(ModelParameterKind kind);
/// Whether MuJoCo derives constants from it (mj_setConst).
bool IsDerivedFrom(ModelParameterKind kind);

/// Relative standard deviation with which such a number is known without measuring it:
/// masses by weighing 1 %, inertias from drawings 3 %, centres of mass 3 % of the radius of
/// gyration, mounts and springs, tendons among them, 5 %, damping and dry friction 20 %,
/// motor constants from data sheets 1 %, rotors 5 %, resistances 3 %. A kp is set in a
/// drive, exact but for the motor constant behind it, 1 %; a kv acts on a speed that the
/// drive makes of its encoder through a filter, 5 %. Joints that are homed on an index
/// pulse or on absolute encoders come back to 0.2 mrad of where they are drawn.
double UsualSpread(ModelParameterKind kind);
/// Standard deviation of the logarithm of a number that nobody has measured on the machine
/// itself: masses 5 %, inertias, rotors and springs 10 %, centres of mass 10 % of the
/// radius of gyration, motor constants 5 %, resistances 10 %, damping and dry friction a
/// factor of 2. A drive counts its kp and kv in units of its own, and what an MJCF has of
/// them is often tuned by hand, 20 %. Joints that are homed on marks or an end stop are off
/// by 5 mrad.
double UsualDoubt(ModelParameterKind kind);

}  // namespace mjdiag
