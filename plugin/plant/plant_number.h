#pragma once
// The numbers of a plant that nobody knows exactly, and how well they are known. A
// number is what an element of the MJCF is made of, by kind:
//
//   mass@<body>, inertia@<body>              of it and what it weighs
//   stiffness@<joint>, damping@<joint>, friction@<joint>
//   armature@<joint>                         inertia of the rotor, behind its gears
//   gear@<actuator>                          force of a unit of its control
//   gain@<actuator>                          of one with a bias: gain and bias together,
//                                            1 / R of a DC motor driven by a voltage
//   centre_x@<body>, centre_y@, centre_z@    centre of mass along an axis of the body's
//                                            frame. A factor f of it is a shift by ln f
//                                            radii of gyration, sqrt(tr I / (2 m)): what
//                                            is known of it goes by the size of the body,
//                                            and whatever f is, the body stays one that
//                                            there can be
//
// A plant says how well one is known by a relative standard deviation of its own,
//   <custom><numeric name="known.stiffness@X" data="0.02"/></custom>
// or of all that have none, `known` (0: a plant that is what it says, as a simulated
// one). Without either it is known as its kind usually is (UsualSpread).

#include <mujoco/mujoco.h>

#include <string>
#include <utility>
#include <vector>

namespace mjdiag {

enum class PlantNumberKind {
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
  kCentreZ
};

struct PlantNumber {
  PlantNumberKind kind = PlantNumberKind::kMass;
  int element = 0;  ///< id of the body, joint or actuator

  bool operator==(const PlantNumber&) const = default;
};

/// "stiffness@X".
std::string PlantNumberName(const mjModel& model, const PlantNumber& number);
/// Of that name. InputError on an unknown kind or element.
PlantNumber FindPlantNumber(const mjModel& model, const std::string& name);

/// All that are not 0, of bodies that move; without centres of mass.
std::vector<PlantNumber> PlantNumbers(const mjModel& model);
/// Centres of mass of all bodies that move: what a machine that leaves its rest shows.
std::vector<PlantNumber> CentreNumbers(const mjModel& model);
bool IsCentre(PlantNumberKind kind);
/// By how far a centre of mass moves with the logarithm of its factor [m].
double CentreUnit(const mjModel& model, const PlantNumber& number);
/// Those of them that a text means: "all", a kind ("mass") or one ("mass@stage").
/// InputError if it means none.
std::vector<PlantNumber> PlantNumbersOf(const mjModel& model, const std::string& text);

/// Relative standard deviation with which such a number is known without measuring it:
/// masses by weighing 1 %, inertias from drawings 3 %, centres of mass 3 % of the radius of
/// gyration, mounts and springs 5 %, damping
/// and dry friction 20 %, motor constants from data sheets 1 %, rotors 5 %, resistances
/// 3 %.
double UsualSpread(PlantNumberKind kind);
/// As the plant declares it, else UsualSpread. InputError on a declaration that names
/// nothing or is not a number >= 0.
double SpreadOf(const mjModel& model, const PlantNumber& number);
/// Standard deviation of the logarithm of a number that nobody has measured on the
/// machine itself, when a record of it is explained: as the plant declares it above 0,
/// else masses 5 %, inertias, rotors and springs 10 %, centres of mass 10 % of the radius
/// of gyration, motor constants 5 %, resistances
/// 10 %, damping and dry friction a factor of 2.
double DoubtOf(const mjModel& model, const PlantNumber& number);
/// Whether the plant says of itself that it is what it says (`known` 0).
bool IsExact(const mjModel& model);

/// Numbers of a plant with the factors that multiply them.
using NumberFactors = std::vector<std::pair<PlantNumber, double>>;

/// Multiplies it. Masses and inertias ask for mj_setConst afterwards.
void Scale(mjModel& model, const PlantNumber& number, double factor);
/// Multiplies them all, with what MuJoCo derives from masses.
void ScaleNumbers(mjModel& model, const NumberFactors& factors);
/// Makes it `factor` times what it is in `nominal`.
void SetNumber(mjModel& model, const mjModel& nominal, const PlantNumber& number,
               double factor);
/// After masses were changed: what MuJoCo derives from them.
void DeriveConstants(mjModel& model);

}  // namespace mjdiag
