#pragma once
// What the name of a column says: "FL_hip_pos_deg" is a position, in degrees, of FL_hip;
// "tau_des[3]" a drive that was wanted, of number 3. Names of joints, sensors and motors are
// read in the same way, so that the two can be laid beside one another.

#include <optional>
#include <string>
#include <vector>

#include "mjdiag/signals/record_source.h"
#include "mjdiag/signals/unit.h"

namespace mjdiag {

/// What a column is of.
enum class Quantity {
  kUnknown,
  kTime,
  kPosition,
  kVelocity,
  kAcceleration,
  kDrive  ///< force, torque, current, voltage: what a motor is given or gives
};

/// Which of several of one quantity it is.
enum class ColumnRole {
  kPlain,      ///< the name does not say
  kMeasured,   ///< "meas", "actual"
  kCommand,    ///< "cmd", "ctrl"
  kReference,  ///< "ref", "des", "goal": what was wanted
  kOther       ///< parts of a command, errors, switches: nothing that a setup takes
};

/// The rest of a name, which says of what.
struct PlaceWords {
  std::vector<std::string> words;    ///< small letters: "fl", "hip"
  std::vector<std::string> generic;  ///< words that many names have: "joint", "motor"
  std::vector<int> numbers;

  bool operator==(const PlaceWords&) const = default;
};

struct ColumnWords {
  std::string name;  ///< without its unit
  Quantity quantity = Quantity::kUnknown;
  ColumnRole role = ColumnRole::kPlain;
  PlaceWords place;
  /// As the setup is to say it; none where neither the file nor the name says one.
  std::optional<std::string> unit;
  bool unit_in_header = false;  ///< it stands in the file, as the setup would say it
  bool switches = false;        ///< "enable": says whether a motor is on
  std::string unknown_unit;     ///< in the file, and none of those that are known

  /// In SI, "1" of none.
  std::string Dimension() const;
};

/// The unit decides what the words leave open, and corrects them: "t1 [N]" is no time.
ColumnWords ReadColumnWords(const SourceColumn& column);

/// The place that the name of a joint, sensor or motor tells.
PlaceWords ReadPlaceWords(const std::string& name);

/// Letters and digits of a name alone, in small letters: "FL-Hip [0]" and "fl_hip0".
std::string Squeezed(const std::string& name);

/// How well two places agree, 0 .. 1; 0.3 where one of them says nothing, less than 0 where
/// their numbers contradict each other.
double Agreement(const PlaceWords& column, const PlaceWords& element);

}  // namespace mjdiag
