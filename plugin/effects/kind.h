#pragma once
// Kinds of physics, as people speak of them before they ask for a law: what has to be oiled,
// tightened, or measured again. Every effect is of one kind; which of its laws it is the
// kind leaves open.

#include <string>

#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

enum class Kind {
  kDryFriction,
  kViscousFriction,
  kLoadFriction,
  kCompliance,
  kPlay,
  kEndStop,
  kInertia,
  kDriveGain,
  kDriveLimit,
  kDelay,
  kConstantForce,
  kForceAlongStroke,
  kCoupling,
  kEncoder,
  kVibration,
  kUnknownForce
};

/// "dry friction".
std::string KindName(Kind kind);
/// What it does: "a resistance that does not grow with speed".
std::string KindMeaning(Kind kind);
/// What a number of the plant that is another one is.
Kind KindOf(ModelParameterKind number);

}  // namespace mjdiag
