#pragma once
// Cases that a search for causes is judged by: something is put into a machine, and the
// truth about it is written down in the words of an answer.

#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "support/hidden_cases/case_dice.h"
#include "support/hidden_cases/hidden_physics.h"

namespace mjdiag::test {

/// A way to say a cause right: an effect or a fault parameter at a site with its
/// parameters, or "number" with the name of a number of the plant for its site and "factor".
struct TrueForm {
  std::string name;
  std::string site;
  std::map<std::string, double> values;
};

/// One cause.
struct TrueCause {
  /// Kinds of physics by which it may be called (kind.h), and where.
  std::vector<std::string> kinds;
  std::vector<std::string> sites;
  /// Any of them is right; none: a law of no list, of which kind and place are asked.
  std::vector<TrueForm> forms = {};
  /// As `--effect` takes it, where the catalogue has it.
  std::string effect = {};
};

struct Hidden {
  HiddenPhysics physics;
  std::vector<TrueCause> truth;
};

/// The case of a machine that lacks nothing.
Hidden Nothing(const Machine&, CaseDice&);

struct HiddenCase {
  std::string name;
  std::string words;  ///< what it is, for people
  /// Sizes of invented laws may be drawn. Laws may remember things: each run takes its own.
  std::function<Hidden(const Machine&, CaseDice&)> draw;
};

/// What the ten laws and numbers of the catalogue do in the wire bonder.
const std::vector<HiddenCase>& BonderCatalogueCases();
/// Laws of no list, in its guides, parasitic joints, drives, encoders and floor.
const std::vector<HiddenCase>& BonderInventedCases();

inline constexpr double kTurn = 2.0 * std::numbers::pi;  ///< [rad]

/// Degree of freedom of a joint, and places of an actuator and a sensor channel.
Eigen::Index JointOf(const Machine& machine, const std::string& name);
Eigen::Index ActuatorOf(const Machine& machine, const std::string& channel);
Eigen::Index SensorOf(const Machine& machine, const std::string& channel);

}  // namespace mjdiag::test
