#pragma once
// Where `mjdiag linearize --at` is, and how that is said.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/operating_point.h"

namespace mjdiag::app {

struct NamedPoint {
  OperatingPoint point;
  std::string place;  ///< "the rest", "keyframe 'home'"
};

/// @param at  "rest", "start" (the configuration that the MJCF draws), "keyframe:NAME" or
///            "RECORD@TIME". InputError on another, with the keyframes of the plant
/// @param notes  receives what one should know about the record
NamedPoint FindPoint(const Machine& machine, const std::string& at,
                     std::vector<std::string>& notes);

/// The record of "RECORD@TIME"; empty of another place.
std::string RecordOfPoint(const std::string& at);

/// `about` of the document: at, pose {joint}, rests, stable, holding_force {coordinate},
/// the part of it that no actuator makes in applied_force (of a moment of a record what
/// the model lacks there), inputs {channel}, of a motion velocity {coordinate}.
nlohmann::json PointJson(const Machine& machine, const NamedPoint& named, bool stable);

/// One line: where it is, what holds it, and whether it falls from there.
std::string PlaceText(const Machine& machine, const NamedPoint& named, bool stable);

}  // namespace mjdiag::app
