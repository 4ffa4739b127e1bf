#include "mjdiag/plugin/effects/kind.h"

#include <utility>

namespace mjdiag {
namespace {

/// Name and meaning.
std::pair<const char*, const char*> TextOf(Kind kind) {
  switch (kind) {
    case Kind::kDryFriction:
      return {"dry friction", "a resistance that does not grow with speed"};
    case Kind::kViscousFriction:
      return {"viscous friction", "a resistance that changes with speed"};
    case Kind::kLoadFriction:
      return {"load friction", "a resistance that grows with the load"};
    case Kind::kCompliance:
      return {"compliance", "a spring, or a structure that gives"};
    case Kind::kPlay:
      return {"play", "a gap that is crossed before force is passed on"};
    case Kind::kEndStop:
      return {"end stop", "contact at an end of the stroke"};
    case Kind::kInertia:
      return {"inertia", "a mass that moves too"};
    case Kind::kDriveGain:
      return {"drive gain", "force or torque for a command"};
    case Kind::kDriveLimit:
      return {"drive limit", "a force, torque or current that is not exceeded"};
    case Kind::kDelay:
      return {"delay", "commands that act late"};
    case Kind::kConstantForce:
      return {"constant force", "a push that is always there"};
    case Kind::kForceAlongStroke:
      return {"force along the stroke", "a push that repeats with the position"};
    case Kind::kCoupling:
      return {"coupling", "a drive that pushes another joint as well"};
    case Kind::kEncoder:
      return {"encoder", "readings that are not where the machine is"};
    case Kind::kVibration:
      return {"vibration", "a shaking from outside"};
    case Kind::kUnknownForce:
      return {"force without a name", "what no law of the list is like"};
  }
  return {"", ""};
}

}  // namespace

std::string KindName(Kind kind) { return TextOf(kind).first; }

std::string KindMeaning(Kind kind) { return TextOf(kind).second; }

Kind KindOf(ModelParameterKind number) {
  switch (number) {
    case ModelParameterKind::kMass:
    case ModelParameterKind::kInertia:
    case ModelParameterKind::kArmature:
    case ModelParameterKind::kCentreX:
    case ModelParameterKind::kCentreY:
    case ModelParameterKind::kCentreZ:
      return Kind::kInertia;
    case ModelParameterKind::kStiffness:
    case ModelParameterKind::kTendonStiffness:
      return Kind::kCompliance;
    case ModelParameterKind::kDamping:
    case ModelParameterKind::kTendonDamping:
      return Kind::kViscousFriction;
    case ModelParameterKind::kFriction:
    case ModelParameterKind::kTendonFriction:
      return Kind::kDryFriction;
    case ModelParameterKind::kGear:
    case ModelParameterKind::kGain:
    case ModelParameterKind::kKp:
    case ModelParameterKind::kKv:
      return Kind::kDriveGain;
    case ModelParameterKind::kRef:
      return Kind::kEncoder;
  }
  return Kind::kUnknownForce;
}

}  // namespace mjdiag
