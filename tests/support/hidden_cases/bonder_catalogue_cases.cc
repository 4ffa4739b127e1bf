// The wire bonder with what the catalogue of effects has, written anew.

#include <cmath>
#include <numbers>

#include "mjdiag/signals/number_text.h"
#include "support/hidden_cases/hidden_case.h"

namespace mjdiag::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Truth of one form that the catalogue has, and others that say the same.
TrueCause Listed(const std::string& kind, const std::vector<std::string>& places,
                 const TrueForm& form, const std::vector<TrueForm>& same = {}) {
  TrueCause cause{{kind}, places, {form}};
  cause.sites.push_back(form.site);
  cause.effect = form.name + "@" + form.site + ":";
  const char* comma = "";
  for (const auto& [name, value] : form.values) {
    cause.effect += comma + name + "=" + AllDigits(value);
    comma = ",";
  }
  cause.forms.insert(cause.forms.end(), same.begin(), same.end());
  return cause;
}

TrueCause WeakenMotor(const Machine& machine, const std::string& axis, double factor,
                      HiddenPhysics& physics) {
  physics.drives.push_back([u = ActuatorOf(machine, "u_" + axis), factor](
                               const Moment&, VectorXd& drive) { drive[u] *= factor; });
  const std::string motor = axis + "_motor";
  return Listed("drive gain",
                {axis == "x"   ? "X"
                 : axis == "y" ? "Y"
                               : "Z"},
                {"motor_constant", motor, {{"factor", factor}}},
                {{"eta_" + axis, "", {{"factor", factor}}},
                 {"number", "gear@" + motor, {{"factor", factor}}}});
}

TrueCause StiffenDamper(const Machine& machine, const std::string& joint, double factor,
                        HiddenPhysics& physics) {
  const Index j = JointOf(machine, joint);
  const double more = (factor - 1.0) * machine.plant().dof_damping[j];
  physics.forces.push_back(
      [j, more](const Moment& at, VectorXd& force) { force[j] -= more * at.v[j]; });
  std::vector<TrueForm> same = {{"number", "damping@" + joint, {{"factor", factor}}}};
  if (joint != "Z") {
    same.push_back({joint == "X" ? "zeta_x" : "zeta_y", "", {{"factor", factor}}});
  }
  return Listed("viscous friction", {},
                {"viscous_friction", joint, {{"coefficient", more}}}, same);
}

Hidden WeakMotor(const Machine& machine, CaseDice&) {
  Hidden hidden;
  hidden.truth.push_back(WeakenMotor(machine, "y", 0.985, hidden.physics));
  return hidden;
}

// Not the drive of x: with that delay its loop rings, and the model in its own longer steps
// falls out of it.
Hidden LateDrive(const Machine& machine, CaseDice&) {
  Hidden hidden;
  const double late = 0.75 * machine.rates().tick();
  hidden.physics.input_delay =
      VectorXd::Zero(static_cast<Index>(machine.channels().actuators.size()));
  hidden.physics.input_delay[ActuatorOf(machine, "u_y")] = late;
  hidden.truth = {
      Listed("delay", {"Y"}, {"input_delay", "y_motor", {{"delay", late}}})};
  return hidden;
}

Hidden CubicSpring(const Machine& machine, CaseDice&) {
  constexpr double kCoefficient = 2.2e7;  // N/m^3: 1.4 N at the end of a move
  Hidden hidden;
  hidden.physics.forces.push_back(
      [y = JointOf(machine, "Y")](const Moment& at, VectorXd& force) {
        force[y] -= kCoefficient * std::pow(at.q[y], 3);
      });
  hidden.truth = {Listed("compliance", {},
                         {"cubic_stiffness", "Y", {{"coefficient", kCoefficient}}})};
  return hidden;
}

Hidden SoftMount(const Machine& machine, CaseDice&) {
  constexpr double kFactor = 0.9;
  const Index mount = JointOf(machine, "u2");
  const double less = (1.0 - kFactor) * machine.plant().jnt_stiffness[mount];
  Hidden hidden;
  hidden.physics.forces.push_back([mount, less](const Moment& at, VectorXd& force) {
    force[mount] += less * at.q[mount];
  });
  hidden.truth = {Listed("compliance", {},
                         {"structural_stiffness", "u2", {{"factor", kFactor}}},
                         {{"number", "stiffness@u2", {{"factor", kFactor}}},
                          {"linear_stiffness", "u2", {{"stiffness", -less}}}})};
  return hidden;
}

Hidden DamperOfZ(const Machine& machine, CaseDice&) {
  Hidden hidden;
  hidden.truth.push_back(StiffenDamper(machine, "Z", 1.4, hidden.physics));
  return hidden;
}

Hidden SealAndRipple(const Machine& machine, CaseDice&) {
  constexpr double kSeal = 0.9;                                    // N
  constexpr double kRipple = 1.3, kPeriod = 1.6e-3, kPhase = 0.7;  // N, m, rad
  const Index x = JointOf(machine, "X");
  const Index y = JointOf(machine, "Y");
  Hidden hidden;
  hidden.physics.dry.push_back(
      [y](const Moment&, VectorXd& bound) { bound[y] += kSeal; });
  hidden.physics.forces.push_back([x](const Moment& at, VectorXd& force) {
    force[x] += kRipple * std::sin(2.0 * std::numbers::pi * at.q[x] / kPeriod + kPhase);
  });
  const double own = machine.plant().dof_frictionloss[y];
  hidden.truth = {
      Listed("dry friction", {}, {"coulomb_friction", "Y", {{"force", kSeal}}},
             {{"number", "friction@Y", {{"factor", 1.0 + kSeal / own}}}}),
      Listed("force along the stroke", {},
             {"force_ripple",
              "X",
              {{"amplitude", kRipple}, {"period", kPeriod}, {"phase", kPhase}}})};
  return hidden;
}

Hidden MotorDamperDrift(const Machine& machine, CaseDice&) {
  constexpr double kRate = 1e-4;  // rad/s: an arm that warms
  Hidden hidden;
  hidden.truth.push_back(WeakenMotor(machine, "x", 0.98, hidden.physics));
  hidden.truth.push_back(StiffenDamper(machine, "Y", 1.2, hidden.physics));
  hidden.physics.readings.push_back(
      [z = SensorOf(machine, "z")](const Moment& at, VectorXd& y) {
        y[z] += kRate * at.t;
      });
  hidden.truth.push_back(
      Listed("encoder", {"Z"}, {"encoder_drift", "z_encoder", {{"rate", kRate}}}));
  return hidden;
}

Hidden Across(const Machine& machine, CaseDice&) {
  constexpr double kShare = 0.015;
  Hidden hidden;
  hidden.physics.forces.push_back(
      [y = JointOf(machine, "Y"), x = ActuatorOf(machine, "u_x")](
          const Moment& at, VectorXd& force) { force[y] += kShare * at.u[x]; });
  hidden.truth = {
      Listed("coupling", {}, {"force_coupling", "Y", {{"coefficient", kShare}}})};
  return hidden;
}

Hidden EddyBrake(const Machine& machine, CaseDice&) {
  constexpr double kCoefficient = 40.0;  // N s/m
  constexpr double kVelocity = 0.11;     // m/s
  Hidden hidden;
  hidden.physics.forces.push_back(
      [x = JointOf(machine, "X")](const Moment& at, VectorXd& force) {
        const double ratio = at.v[x] / kVelocity;
        force[x] -= kCoefficient * at.v[x] / (1.0 + ratio * ratio);
      });
  hidden.truth = {Listed("viscous friction", {},
                         {"eddy_current_brake",
                          "X",
                          {{"coefficient", kCoefficient}, {"velocity", kVelocity}}})};
  return hidden;
}

}  // namespace

const std::vector<HiddenCase>& BonderCatalogueCases() {
  static const std::vector<HiddenCase> cases = {
      {"nothing", "nothing is hidden", Nothing},
      {"weak_motor", "the motor of y is 1.5 % weak", WeakMotor},
      {"late_drive", "the drive of y is 0.75 ticks late", LateDrive},
      {"cubic_spring", "a spring that stiffens on y", CubicSpring},
      {"soft_mount", "the mount of the chassis along y is 10 % softer", SoftMount},
      {"damper_z", "the damper of z is 1.4 times as large", DamperOfZ},
      {"seal_and_ripple", "a seal on y and a ripple on x", SealAndRipple},
      {"motor_damper_drift", "motor of x, damper of y, drift of z's encoder",
       MotorDamperDrift},
      {"across", "1.5 % of the force of x's motor acts on y", Across},
      {"eddy_brake", "an eddy-current brake on x", EddyBrake},
  };
  return cases;
}

}  // namespace mjdiag::test
