// Laws of no list in the wire bonder: in its guides and its parasitic joints. Those of its
// drives, encoders and floor are in bonder_invented_drives.cc.

#include <cmath>
#include <vector>

#include "support/hidden_cases/bonder_invented.h"

namespace mjdiag::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

const char* const kUnnamed = "force without a name";

/// A film of grease that shear thins while it is worked and heals while it rests:
/// -c (1 - s) v, ds/dt = |v| / length (1 - s) - s / heals.
Hidden ThinningGrease(const Machine& machine, CaseDice& dice) {
  const Index x = JointOf(machine, "X");
  const double c = dice.About(25.0);       // N s/m
  const double length = dice.About(4e-3);  // m
  const double heals = dice.About(0.08);   // s
  Hidden hidden;
  const Index s = hidden.physics.Remember(0.0);
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& force) {
    force[x] -= c * (1.0 - at.z[s]) * at.v[x];
  });
  hidden.physics.remembers.push_back([=](const Moment& at, VectorXd& rate) {
    rate[s] += std::abs(at.v[x]) / length * (1.0 - at.z[s]) - at.z[s] / heals;
  });
  hidden.truth = {{{"viscous friction"}, {"X"}}};
  return hidden;
}

/// Where two rails meet the balls climb over an edge: the force of a bump of that height
/// and width.
Hidden RailJoint(const Machine& machine, CaseDice& dice) {
  const Index y = JointOf(machine, "Y");
  const double place = dice.Sign() * dice.Even(0.4e-3, 1.4e-3);  // m
  const double width = dice.About(0.25e-3);                      // m
  const double force = dice.About(2.5);                          // N, at the steepest
  Hidden hidden;
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& all) {
    const double s = (at.q[y] - place) / width;
    all[y] += force * s * std::exp(0.5 - 0.5 * s * s);
  });
  hidden.truth = {{{"force along the stroke", "compliance", kUnnamed}, {"Y"}}};
  return hidden;
}

/// The lip of a wiper that drags in one direction only, the more the further it is pushed:
/// dry friction F (1 + tanh(q / length)) for v > 0.
Hidden WiperLip(const Machine& machine, CaseDice& dice) {
  const Index y = JointOf(machine, "Y");
  const double force = dice.About(1.2);      // N
  const double length = dice.About(1.5e-3);  // m
  Hidden hidden;
  hidden.physics.dry.push_back([=](const Moment& at, VectorXd& bound) {
    if (at.v[y] > 0.0) bound[y] += force * (1.0 + std::tanh(at.q[y] / length));
  });
  hidden.truth = {{{"dry friction"}, {"Y"}}};
  return hidden;
}

/// A drag chain whose bend rolls along with the stage: its pull is bounded, and it lags
/// by the loss of its links.
Hidden CableChain(const Machine& machine, CaseDice& dice) {
  const Index x = JointOf(machine, "X");
  const double force = dice.About(3.0);    // N
  const double length = dice.About(2e-3);  // m
  const double lag = dice.About(0.3e-3);   // m
  Hidden hidden;
  const Index w = hidden.physics.Remember(0.0);
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& all) {
    all[x] -= force * std::tanh((at.q[x] + at.z[w]) / length);
  });
  hidden.physics.remembers.push_back([=](const Moment& at, VectorXd& rate) {
    rate[w] += at.v[x] - std::abs(at.v[x]) * at.z[w] / lag;
  });
  hidden.truth = {{{"compliance"}, {"X"}}};
  return hidden;
}

/// What y's motor pulls at the yawing stage loads the guide of x: ideal dry friction that
/// grows with the force of the other motor.
Hidden CrossLoad(const Machine& machine, CaseDice& dice) {
  const Index x = JointOf(machine, "X");
  const Index motor = ActuatorOf(machine, "u_y");
  const double share = dice.About(0.03);
  Hidden hidden;
  hidden.physics.dry.push_back([=](const Moment& at, VectorXd& bound) {
    bound[x] += share * std::abs(at.u[motor]);
  });
  hidden.truth = {{{"dry friction", "load friction", "coupling"}, {"X"}}};
  return hidden;
}

/// A carriage whose balls on one side have lost their preload: the spring across the guide
/// of y gives more to that side, with a smooth passage.
Hidden LostPreload(const Machine& machine, CaseDice& dice) {
  const Index across = JointOf(machine, "u4");
  const double k = machine.plant().jnt_stiffness[across];
  const double less = k * dice.Even(0.3, 0.5);
  const double passage = dice.About(1e-7);  // m
  const double side = dice.Sign();
  Hidden hidden;
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& force) {
    const double s = side * at.q[across] / passage;
    // Softplus: 0 on one side, q on the other.
    const double given = s > 30.0 ? s : std::log1p(std::exp(s));
    force[across] += side * less * passage * (given - std::log(2.0));
  });
  hidden.truth = {{{"compliance", "play"}, {"u4"}}};
  return hidden;
}

/// Rubber under the chassis: a spring in line with a damper beside the mount's own,
/// dz/dt = v - z / relaxes, force -k z.
Hidden CreepingMount(const Machine& machine, CaseDice& dice) {
  const Index mount = JointOf(machine, "u1");
  const double k = machine.plant().jnt_stiffness[mount] * dice.Even(0.3, 0.6);
  const double relaxes = dice.About(4e-3);  // s
  Hidden hidden;
  const Index z = hidden.physics.Remember(0.0);
  hidden.physics.forces.push_back(
      [=](const Moment& at, VectorXd& force) { force[mount] -= k * at.z[z]; });
  hidden.physics.remembers.push_back([=](const Moment& at, VectorXd& rate) {
    rate[z] += at.v[mount] - at.z[z] / relaxes;
  });
  hidden.truth = {{{"compliance", "viscous friction"}, {"u1"}}};
  return hidden;
}

/// The air that the moving x-stage pushes against the arm.
Hidden Windage(const Machine& machine, CaseDice& dice) {
  const Index z = JointOf(machine, "Z");
  const Index x = JointOf(machine, "X");
  const double torque = dice.About(0.05);  // N m s^2/m^2
  Hidden hidden;
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& force) {
    force[z] += torque * at.v[x] * at.v[x];
  });
  hidden.truth = {{{"coupling", kUnnamed}, {"Z"}}};
  return hidden;
}

}  // namespace

const std::vector<HiddenCase>& BonderInventedCases() {
  static const std::vector<HiddenCase> cases = [] {
    std::vector<HiddenCase> all = {
        {"thinning_grease", "grease on x that thins while it is worked",
         ThinningGrease},
        {"rail_joint", "an edge between two rails of y", RailJoint},
        {"wiper_lip", "a wiper on y that drags one way, by the place", WiperLip},
        {"cable_chain", "a drag chain at x whose bend rolls along", CableChain},
        {"cross_load", "the guide of x rubs by what y's motor pulls", CrossLoad},
        {"lost_preload", "the guide of y gives more to one side across", LostPreload},
        {"creeping_mount", "rubber under the chassis that creeps along x",
         CreepingMount},
        {"windage", "the air of the x-stage pushes the arm", Windage},
    };
    for (const HiddenCase& one : InventedDriveCases()) all.push_back(one);
    return all;
  }();
  return cases;
}

}  // namespace mjdiag::test
