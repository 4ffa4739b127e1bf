#include "mjdiag/discovery/checks/unit_check.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/checks/likeness.h"
#include "mjdiag/discovery/checks/nominal_run.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kFarOff = 2.0;  // tolerance of factors that no machine has
constexpr double kDegreesOnly = 1.1;
constexpr double kSameSize = 3.0;

/// What may have been mistaken about a channel.
struct Mistake {
  double factor = 1.0;  ///< with its sign
  std::string name;     ///< of the factor
  /// Of the unit in the record; empty: an angle, or the sign alone.
  std::string prefix{};
};

bool IsAngle(const std::string& unit) { return unit.starts_with("rad"); }

bool IsAbout(double factor, double expected, double tolerance) {
  return std::abs(std::log(factor / expected)) <= std::log(tolerance);
}

std::vector<Mistake> MistakesOf(bool angle) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::vector<Mistake> mistakes = {{1e3, "1000", "m"},
                                   {1e6, "1000000", "u"},
                                   {1e-3, "0.001", "k"},
                                   {1e-6, "0.000001", "M"}};
  if (angle) {
    mistakes.push_back({kDegrees, "180 / pi"});
    mistakes.push_back({1.0 / kDegrees, "pi / 180"});
  }
  return mistakes;
}

Mistake Flipped(const Mistake& mistake) {
  return {-mistake.factor, "-" + mistake.name, mistake.prefix};
}

/// @param degrees  tolerance of degrees and radians; 0: no angle
std::optional<Mistake> FindMistake(const Likeness& likeness, double degrees) {
  for (const Mistake& mistake : MistakesOf(degrees > 0.0)) {
    const double tolerance = mistake.prefix.empty() ? degrees : kFarOff;
    if (!IsAbout(likeness.factor, mistake.factor, tolerance)) continue;
    return likeness.correlation < 0.0 ? Flipped(mistake) : mistake;
  }
  return std::nullopt;
}

/// @param against    what it is held against, for people
/// @param otherwise  where else the mistake may lie
[[noreturn]] void RefuseUnit(const std::string& channel, const std::string& unit,
                             const Mistake& mistake, const std::string& against,
                             const std::string& otherwise) {
  const double size = std::abs(mistake.factor);
  const bool flipped = mistake.factor < 0.0;
  const std::string taken = mistake.prefix.empty()
                                ? (size > 1.0 ? std::string("degrees taken for rad")
                                              : std::string("rad taken for degrees"))
                                : mistake.prefix + unit + " taken for " + unit;
  throw InputError("record",
                   "wrong units" + std::string(flipped ? " and sign" : "") + ": '" +
                       channel + "' reads " + mistake.name + " times " + against +
                       ": " + taken + (flipped ? " and flipped" : "") + ", or " +
                       otherwise + " the other way round?",
                   "SI; a column under [record.channels] may give the unit");
}

[[noreturn]] void RefuseSign(const std::string& channel, const std::string& against,
                             const std::string& otherwise) {
  throw InputError("record",
                   "channel '" + channel + "' is about -1 times " + against +
                       ": flipped sign of it, or of " + otherwise + "?",
                   "every channel in the direction that the plant counts positive");
}

std::string ReferenceOf(const AxisSetup& axis) { return axis.name + "_ref"; }

/// Of the recorded input, what the controllers of the setup do not command for the
/// reference and the reading of the record; with either sign of the input, so that a
/// reference may be flipped, too.
double UnlikeCommand(const Setup& setup, const Record& record, const AxisSetup& axis) {
  const VectorXd input = CountedSamples(setup, record, axis.actuator);
  const VectorXd command = CommandedInput(setup, record, axis.actuator);
  return std::min((input - command).norm(), (input + command).norm()) / input.norm();
}

/// What the controllers saw: UnlikeCommand of a record and of one without a mistake.
struct Sight {
  double as_is = 0.0;
  double corrected = 0.0;

  /// None if they command the recorded input for neither.
  std::optional<bool> WasMistaken() const {
    constexpr double kLike = 0.4;
    constexpr double kLiker = 2.0;
    if (corrected < kLike && kLiker * corrected < as_is) return true;
    if (as_is < kLike) return false;
    return std::nullopt;
  }
};

/// @param factor  of the reading over its reference; either may be the mistaken one
Sight Look(const Setup& setup, const Record& measured, const AxisSetup& axis,
           double factor) {
  const auto with = [&](const std::string& channel, double correction) {
    return UnlikeCommand(setup, WithScaled(measured, channel, correction), axis);
  };
  return {UnlikeCommand(setup, measured, axis),
          std::min(with(axis.sensor, 1.0 / factor), with(ReferenceOf(axis), factor))};
}

/// Of a reading whose size is nearer to a mistake than to its reference: the one that the
/// controllers did not see. A loop need not follow.
std::optional<Mistake> UnseenMistake(const Setup& setup, const Record& measured,
                                     const AxisSetup& axis, const Likeness& likeness) {
  std::optional<Mistake> found;
  double best = std::numeric_limits<double>::infinity();
  const bool angle = IsAngle(setup.channels.Sensor(axis.sensor).unit);
  for (const Mistake& size : MistakesOf(angle)) {
    const double half = std::sqrt(std::max(size.factor, 1.0 / size.factor));
    if (!IsAbout(likeness.factor, size.factor, half)) continue;
    for (const Mistake& mistake : {size, Flipped(size)}) {
      const Sight sight = Look(setup, measured, axis, mistake.factor);
      if (!sight.WasMistaken().value_or(false) || sight.corrected >= best) continue;
      best = sight.corrected;
      found = mistake;
    }
  }
  return found;
}

/// Refuses the reading of an axis for what it is like. A machine that is stuck, or beyond
/// its bandwidth, may move like that, too: then the controllers saw what is recorded.
void JudgeReading(const Setup& setup, const Record& measured, const AxisSetup& axis,
                  const Likeness& likeness, const std::string& against,
                  const std::string& otherwise) {
  constexpr double kLike = 0.9;
  constexpr double kUnlike = -0.5;
  const SensorSetup& sensor = setup.channels.Sensor(axis.sensor);
  const bool alike = std::abs(likeness.correlation) > kLike;
  const auto mistake = FindMistake(likeness, IsAngle(sensor.unit) ? kFarOff : 0.0);
  if (mistake && alike &&
      Look(setup, measured, axis, mistake->factor).WasMistaken().value_or(true)) {
    RefuseUnit(axis.sensor, sensor.unit, *mistake, against, otherwise);
  }
  if (likeness.correlation > kUnlike) return;
  const bool seems =
      alike && likeness.broad && IsAbout(likeness.factor, 1.0, kSameSize);
  if (Look(setup, measured, axis, -1.0).WasMistaken().value_or(seems)) {
    RefuseSign(axis.sensor, against, otherwise);
  }
}

/// InputError if an input is minus what the controllers command.
void CheckInputSign(const Setup& setup, const Record& measured, const AxisSetup& axis) {
  constexpr double kLike = 0.3;
  const VectorXd input = CountedSamples(setup, measured, axis.actuator);
  const VectorXd command = CommandedInput(setup, measured, axis.actuator);
  if ((input + command).norm() >= kLike * input.norm()) return;
  RefuseSign(axis.actuator, "what the controllers command for the recorded motion",
             "'" + axis.sensor + "' and '" + ReferenceOf(axis) + "'");
}

void CheckInputsOfAxes(const Setup& setup, const Record& measured,
                       const Record& simulated) {
  constexpr double kLike = 0.5;
  constexpr double kLikeFlipped = 0.9;
  for (const AxisSetup& axis : setup.control.axes) {
    const Likeness likeness = Liken(CountedSamples(setup, measured, axis.actuator),
                                    CountedSamples(setup, simulated, axis.actuator));
    const bool angle = IsAngle(setup.channels.Sensor(axis.sensor).unit);
    const auto mistake = FindMistake(likeness, angle ? kDegreesOnly : 0.0);
    if (!mistake) continue;
    if (likeness.correlation < kLike && likeness.correlation > -kLikeFlipped) continue;
    RefuseUnit(axis.actuator, setup.channels.Actuator(axis.actuator).unit, *mistake,
               "what the plant needs for that motion",
               "'" + axis.sensor + "' and '" + ReferenceOf(axis) + "'");
  }
}

bool IsStable(const Machine& machine) {
  const Eigen::MatrixXd& K = machine.mechanics().K;
  const Eigen::MatrixXd symmetric = 0.5 * (K + K.transpose());
  const VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
          .eigenvalues();
  return values.minCoeff() >= -1e-9 * values.cwiseAbs().maxCoeff();
}

/// Differences: offsets of force let free axes drift away.
VectorXd Moves(const Setup& setup, const Record& record, const std::string& channel) {
  const VectorXd x = CountedSamples(setup, record, channel);
  const Index span = std::max<Index>(1, x.size() / 500);
  return x.tail(x.size() - span) - x.head(x.size() - span);
}

/// Whether the plant answers half of the input about as it does the whole.
bool AnswersItsInput(const Machine& machine, const Record& measured,
                     const Record& simulated, const std::string& sensor) {
  constexpr double kLike = 0.9;
  constexpr double kHalf = 0.5;
  Record gentle = measured;
  for (const ActuatorSetup& actuator : machine.channels().actuators) {
    gentle = WithScaled(gentle, actuator.channel, kHalf);
  }
  const Likeness likeness =
      Liken(Moves(machine.setup(), NominalRun(machine, gentle, false), sensor),
            Moves(machine.setup(), simulated, sensor));
  return likeness.correlation > kLike && IsAbout(likeness.factor, kHalf, 1.5);
}

/// Whether a free simulation says anything of sizes and signs: of what falls, or runs away
/// for want of friction and controllers, chance says where it is.
bool Tells(const Machine& machine, const Record& measured, const Record& simulated,
           const std::string& sensor) {
  try {
    return IsStable(machine) && AnswersItsInput(machine, measured, simulated, sensor);
  } catch (const NumericalError&) {
    return false;  // no rest, or a run that diverges
  }
}

void CheckReadingsOfPlant(const Machine& machine, const Record& measured,
                          const Record& simulated) {
  constexpr double kLike = 0.7;
  constexpr double kLikeFlipped = -0.85;
  const Setup& setup = machine.setup();
  std::string inputs;
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    inputs += (inputs.empty() ? "'" : ", '") + actuator.channel + "'";
  }
  for (const SensorSetup& sensor : setup.channels.sensors) {
    const Likeness likeness = Liken(Moves(setup, measured, sensor.channel),
                                    Moves(setup, simulated, sensor.channel));
    const double degrees = !IsAngle(sensor.unit) ? 0.0
                           : likeness.broad      ? kFarOff
                                                 : kDegreesOnly;
    const auto mistake = FindMistake(likeness, degrees);
    if (mistake && std::abs(likeness.correlation) >= kLike &&
        Tells(machine, measured, simulated, sensor.channel)) {
      RefuseUnit(sensor.channel, sensor.unit, *mistake, "what the plant does", inputs);
    }
    if (likeness.correlation < kLikeFlipped && likeness.broad &&
        IsAbout(likeness.factor, 1.0, kSameSize) &&
        Tells(machine, measured, simulated, sensor.channel)) {
      RefuseSign(sensor.channel, "what the plant does", inputs);
    }
  }
}

}  // namespace

bool CheckAgainstReferences(const Setup& setup, const Record& measured) {
  constexpr double kLike = 0.9;
  bool follow = true;
  for (const AxisSetup& axis : setup.control.axes) {
    const std::string reference = ReferenceOf(axis);
    const Likeness likeness = Liken(CountedSamples(setup, measured, axis.sensor),
                                    CountedSamples(setup, measured, reference));
    const std::string against = "its reference '" + reference + "'";
    JudgeReading(setup, measured, axis, likeness, against, "'" + reference + "'");
    if (const auto mistake = UnseenMistake(setup, measured, axis, likeness)) {
      RefuseUnit(axis.sensor, setup.channels.Sensor(axis.sensor).unit, *mistake,
                 against, "'" + reference + "'");
    }
    CheckInputSign(setup, measured, axis);
    follow = follow && likeness.correlation > kLike &&
             IsAbout(likeness.factor, 1.0, kSameSize);
  }
  return follow;
}

void CheckAgainstPlant(const Machine& machine, const Record& measured,
                       const Record& simulated) {
  const Setup& setup = machine.setup();
  if (setup.control.axes.empty()) {
    CheckReadingsOfPlant(machine, measured, simulated);
    return;
  }
  for (const AxisSetup& axis : setup.control.axes) {
    JudgeReading(setup, measured, axis,
                 Liken(CountedSamples(setup, measured, axis.sensor),
                       CountedSamples(setup, simulated, axis.sensor)),
                 "what the plant does", "'" + ReferenceOf(axis) + "'");
  }
  CheckInputsOfAxes(setup, measured, simulated);
}

}  // namespace mjdiag
