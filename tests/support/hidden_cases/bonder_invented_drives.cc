// Laws of no list in the drives, encoders and the floor of the wire bonder.

#include <algorithm>
#include <cmath>

#include "support/hidden_cases/bonder_invented.h"

namespace mjdiag::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Magnets of unlike strength: the motor gives more over one pole than over the next.
Hidden UnlikeMagnets(const Machine& machine, CaseDice& dice) {
  const Index motor = ActuatorOf(machine, "u_x");
  const Index x = JointOf(machine, "X");
  const double share = dice.About(0.01);
  const double period = dice.About(3e-3);  // m
  const double phase = dice.Even(0.0, kTurn);
  Hidden hidden;
  hidden.physics.drives.push_back([=](const Moment& at, VectorXd& u) {
    u[motor] *= 1.0 + share * std::sin(kTurn * at.q[x] / period + phase);
  });
  hidden.truth = {{{"drive gain", "force along the stroke"}, {"x_motor", "X"}}};
  return hidden;
}

/// Iron that saturates, on the pushing side only: u / sqrt(1 + (u / limit)^2) for u > 0.
Hidden TiredIron(const Machine& machine, CaseDice& dice) {
  const Index motor = ActuatorOf(machine, "u_y");
  const double limit = dice.About(700.0);  // N; the motor gives up to 180
  Hidden hidden;
  hidden.physics.drives.push_back([=](const Moment&, VectorXd& u) {
    if (u[motor] > 0.0) u[motor] /= std::hypot(1.0, u[motor] / limit);
  });
  hidden.truth = {{{"drive limit", "drive gain"}, {"y_motor", "Y"}}};
  return hidden;
}

/// An amplifier that follows small steps with a lag and large ones at a bounded rate:
/// df/dt = rate tanh((u - f) / (rate lag)).
Hidden SlewingAmplifier(const Machine& machine, CaseDice& dice) {
  const Index motor = ActuatorOf(machine, "u_z");
  const double lag = dice.About(5e-5);    // s
  const double rate = dice.About(800.0);  // N m/s
  Hidden hidden;
  const Index f = hidden.physics.Remember(0.0);
  hidden.physics.drives.push_back(
      [=](const Moment& at, VectorXd& u) { u[motor] = at.z[f]; });
  hidden.physics.remembers.push_back([=](const Moment& at, VectorXd& slope) {
    slope[f] += rate * std::tanh((at.command[motor] - at.z[f]) / (rate * lag));
  });
  hidden.truth = {{{"delay", "drive limit"}, {"z_motor", "Z"}}};
  return hidden;
}

/// A winding that warms with the square of its force and gives less then.
Hidden WarmWinding(const Machine& machine, CaseDice& dice) {
  const Index motor = ActuatorOf(machine, "u_x");
  const double less = dice.About(0.06);  // when warm at half its peak force
  const double square = 220.0 * 220.0;   // N^2
  const double warms = dice.About(0.3);  // s
  Hidden hidden;
  const Index heat = hidden.physics.Remember(0.0);
  hidden.physics.drives.push_back(
      [=](const Moment& at, VectorXd& u) { u[motor] *= 1.0 - less * at.z[heat]; });
  hidden.physics.remembers.push_back([=](const Moment& at, VectorXd& slope) {
    const double u = at.u[motor];
    slope[heat] += (u * u / square - at.z[heat]) / warms;
  });
  hidden.truth = {{{"drive gain"}, {"x_motor", "X"}}};
  return hidden;
}

/// A reading head on a loose screw: it follows the stage with that much play.
Hidden LooseHead(const Machine& machine, CaseDice& dice) {
  const Index y = SensorOf(machine, "y");
  const double play = dice.About(0.8e-6);  // m
  Hidden hidden;
  hidden.physics.readings.push_back(
      [=, head = 0.0](const Moment&, VectorXd& reading) mutable {
        head = std::clamp(head, reading[y] - 0.5 * play, reading[y] + 0.5 * play);
        reading[y] = head;
      });
  hidden.truth = {{{"encoder", "play"}, {"y_encoder", "Y"}}};
  return hidden;
}

/// A scale in two pieces that do not quite agree: another pitch from a place on.
Hidden SplicedScale(const Machine& machine, CaseDice& dice) {
  const Index x = SensorOf(machine, "x");
  const double place = dice.Even(-1e-3, 1e-3);  // m
  const double pitch = dice.Sign() * dice.About(4e-3);
  Hidden hidden;
  hidden.physics.readings.push_back([=](const Moment&, VectorXd& reading) {
    // From 0 on it is right, so that the machine starts where it is read.
    const double beyond = std::max(0.0, reading[x] - place) - std::max(0.0, -place);
    reading[x] += pitch * beyond;
  });
  hidden.truth = {{{"encoder"}, {"x_encoder", "X"}}};
  return hidden;
}

/// A lorry that passes: a burst of that frequency under the chassis, once in a record.
Hidden Lorry(const Machine& machine, CaseDice& dice) {
  const Index floor = JointOf(machine, "u2");
  const double force = dice.About(150.0);  // N, on 310 kg
  const double frequency = dice.About(31.0);
  const double when = dice.Even(0.15, 0.35);  // s
  const double lasts = dice.About(0.06);      // s
  Hidden hidden;
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& all) {
    const double s = (at.t - when) / lasts;
    all[floor] += force * std::sin(kTurn * frequency * at.t) * std::exp(-0.5 * s * s);
  });
  hidden.truth = {{{"vibration", "force without a name"}, {"u2", "Y"}}};
  return hidden;
}

/// A press next door: a blow to the chassis at every stroke, each fading within ms.
Hidden PressNextDoor(const Machine& machine, CaseDice& dice) {
  const Index floor = JointOf(machine, "u1");
  const double force = dice.About(250.0);  // N
  const double every = dice.About(0.11);   // s
  const double fades = dice.About(4e-3);   // s
  Hidden hidden;
  hidden.physics.forces.push_back([=](const Moment& at, VectorXd& all) {
    const double since = std::fmod(at.t, every);
    all[floor] += force * since / fades * std::exp(1.0 - since / fades);
  });
  hidden.truth = {{{"vibration", "force without a name"}, {"u1", "X"}}};
  return hidden;
}

}  // namespace

std::vector<HiddenCase> InventedDriveCases() {
  return {
      {"unlike_magnets", "the motor of x is stronger over every other pole",
       UnlikeMagnets},
      {"tired_iron", "the motor of y saturates where it pushes", TiredIron},
      {"slewing_amplifier", "the amplifier of z lags, and is slow on large steps",
       SlewingAmplifier},
      {"warm_winding", "the motor of x grows weak as it warms", WarmWinding},
      {"loose_head", "the reading head of y has play", LooseHead},
      {"spliced_scale", "the scale of x has another pitch from a place on",
       SplicedScale},
      {"lorry", "a lorry passes", Lorry},
      {"press_next_door", "a press strikes next door", PressNextDoor},
  };
}

}  // namespace mjdiag::test
