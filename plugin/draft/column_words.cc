#include "mjdiag/plugin/draft/column_words.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Words = std::vector<std::string>;

// Words of logs of robots, drives and simulators, as ROS, EtherCAT drives and people name
// them.
const std::map<std::string, Quantity, std::less<>>& Quantities() {
  using enum Quantity;
  static const std::map<std::string, Quantity, std::less<>> kQuantities = [] {
    std::map<std::string, Quantity, std::less<>> all;
    const auto add = [&all](Quantity quantity, const Words& words) {
      for (const std::string& word : words) all[word] = quantity;
    };
    add(kTime, {"t", "time", "times", "timestamp", "stamp", "clock", "elapsed"});
    add(kPosition, {"q", "qpos", "pos", "position", "positions", "angle", "angles",
                    "theta", "phi", "enc", "encoder", "x", "y", "z", "disp",
                    "displacement", "travel", "rotation"});
    add(kVelocity,
        {"qd", "dq", "qdot", "qvel", "vel", "velocity", "velocities", "speed", "omega",
         "w", "xd", "dx", "xdot", "thetadot", "rpm", "tacho", "rate"});
    add(kAcceleration,
        {"qdd", "ddq", "qddot", "qacc", "acc", "accel", "acceleration", "xdd", "ddx"});
    add(kDrive, {"tau",     "torque", "torques", "eff",     "trq",      "effort",
                 "efforts", "f",      "force",   "forces",  "frc",      "u",
                 "i",       "iq",     "uq",      "current", "currents", "cur",
                 "amps",    "volt",   "volts",   "voltage", "v",        "ctrl",
                 "control", "duty",   "pwm",     "thrust",  "moment"});
    return all;
  }();
  return kQuantities;
}

const std::map<std::string, ColumnRole, std::less<>>& Roles() {
  using enum ColumnRole;
  static const std::map<std::string, ColumnRole, std::less<>> kRoles{
      {"meas", kMeasured},       {"measured", kMeasured}, {"act", kMeasured},
      {"actual", kMeasured},     {"fbk", kMeasured},      {"feedback", kMeasured},
      {"present", kMeasured},    {"sensed", kMeasured},   {"cmd", kCommand},
      {"command", kCommand},     {"commanded", kCommand}, {"ctrl", kCommand},
      {"control", kCommand},     {"input", kCommand},     {"ref", kReference},
      {"reference", kReference}, {"des", kReference},     {"desired", kReference},
      {"target", kReference},    {"goal", kReference},    {"setpoint", kReference},
      {"sp", kReference},        {"wanted", kReference},  {"ff", kOther},
      {"feedforward", kOther},   {"err", kOther},         {"error", kOther},
      {"enable", kOther},        {"enabled", kOther},     {"on", kOther},
      {"supply", kOther},        {"temp", kOther},        {"temperature", kOther},
      {"filt", kOther},          {"filtered", kOther},    {"offset", kOther},
      {"limit", kOther},         {"status", kOther},      {"mode", kOther}};
  return kRoles;
}

bool IsGeneric(const std::string& word) {
  static const std::set<std::string, std::less<>> kGeneric{
      "joint",  "joints", "jnt",   "j",      "motor",    "motors", "mot",
      "axis",   "axes",   "ax",    "sensor", "actuator", "drive",  "state",
      "states", "data",   "value", "log",    "robot"};
  return kGeneric.contains(word);
}

/// A unit as people write it, in the words of ParseUnit; none if it is no unit.
std::optional<std::string> UnitWord(const std::string& text) {
  static const std::map<std::string, std::string, std::less<>> kSpelled{
      {"degree", "deg"},  {"degrees", "deg"}, {"\xC2\xB0", "deg"}, {"radian", "rad"},
      {"radians", "rad"}, {"sec", "s"},       {"secs", "s"},       {"second", "s"},
      {"seconds", "s"},   {"msec", "ms"},     {"millis", "ms"},    {"usec", "us"},
      {"micros", "us"},   {"nsec", "ns"},     {"nanos", "ns"},     {"meter", "m"},
      {"meters", "m"},    {"metre", "m"},     {"metres", "m"},     {"amp", "A"},
      {"amps", "A"},      {"volts", "V"},     {"volt", "V"},       {"newton", "N"},
      {"mNm", "mN m"},    {"uNm", "uN m"},    {"kNm", "kN m"},     {"N.m", "N m"},
      {"deg_s", "deg/s"}, {"rad_s", "rad/s"}, {"m_s", "m/s"},      {"mm_s", "mm/s"},
      {"dps", "deg/s"},   {"N_m", "N m"},     {"mN_m", "mN m"}};
  if (const auto found = kSpelled.find(text); found != kSpelled.end()) {
    return found->second;
  }
  try {
    ParseUnit(text);
  } catch (const InputError&) {
    return std::nullopt;
  }
  return text;
}

/// Pieces between what is neither letter nor digit.
Words Pieces(const std::string& name) {
  Words pieces(1);
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0) {
      pieces.back() += c;
    } else if (!pieces.back().empty()) {
      pieces.emplace_back();
    }
  }
  if (pieces.back().empty()) pieces.pop_back();
  return pieces;
}

bool IsNumber(const std::string& word) {
  return !word.empty() && word.find_first_not_of("0123456789") == word.npos;
}

/// "motorPos12" -> motor, pos, 12.
Words Split(const std::string& piece) {
  Words words;
  char before = '\0';
  for (const char c : piece) {
    const auto kind = [](char letter) {
      return std::isdigit(static_cast<unsigned char>(letter)) != 0 ? 1 : 0;
    };
    const bool camel = std::islower(static_cast<unsigned char>(before)) != 0 &&
                       std::isupper(static_cast<unsigned char>(c)) != 0;
    if (before == '\0' || camel || kind(before) != kind(c)) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    before = c;
  }
  return words;
}

/// A unit behind the name, "theta_deg", "deg" of "theta_deg_1" or "rad_s" of "w_rad_s";
/// taken out. A single letter is one in front of nothing else: "u_A", "x_m".
std::optional<std::string> TakeUnit(Words& pieces) {
  const bool index = pieces.size() > 2 && IsNumber(pieces.back());
  const std::size_t end = pieces.size() - (index ? 1 : 0);
  for (const std::size_t count : {std::size_t{2}, std::size_t{1}}) {
    if (end < count + 1) continue;
    std::string text = pieces[end - count];
    if (count == 2) text += "_" + pieces[end - 1];
    if (IsNumber(text) || text.front() == '-') continue;
    const std::optional<std::string> unit = UnitWord(text);
    if (!unit || ParseUnit(*unit).si == "1") continue;
    const auto at = [&pieces](std::size_t i) {
      return pieces.begin() + static_cast<std::ptrdiff_t>(i);
    };
    pieces.erase(at(end - count), at(end));
    return unit;
  }
  return std::nullopt;
}

std::optional<Quantity> QuantityOf(const std::string& dimension) {
  if (dimension == "s") return Quantity::kTime;
  if (dimension == "rad" || dimension == "m") return Quantity::kPosition;
  if (dimension == "rad/s" || dimension == "m/s") return Quantity::kVelocity;
  if (dimension == "rad/s^2" || dimension == "m/s^2") return Quantity::kAcceleration;
  for (const char* drive : {"N", "N m", "A", "V"}) {
    if (dimension == drive) return Quantity::kDrive;
  }
  return std::nullopt;
}

void Sort(const Words& words, ColumnWords& column) {
  for (const std::string& word : words) {
    if (IsNumber(word)) {
      // No place has a number of ten digits.
      column.place.numbers.push_back(word.size() < 9 ? std::stoi(word) : -1);
      continue;
    }
    column.switches = column.switches || word == "enable" || word == "enabled";
    const auto role = Roles().find(word);
    const auto quantity = Quantities().find(word);
    if (role != Roles().end() && column.role != ColumnRole::kOther)
      column.role = role->second;
    if (quantity != Quantities().end() && column.quantity == Quantity::kUnknown) {
      column.quantity = quantity->second;
    }
    if (role != Roles().end() || quantity != Quantities().end()) continue;
    (IsGeneric(word) ? column.place.generic : column.place.words).push_back(word);
  }
}

bool Contains(const Words& words, const std::string& wanted) {
  // "mot" and "motor", "t" and "thrust".
  return std::ranges::any_of(words, [&](const std::string& word) {
    return word.starts_with(wanted) || wanted.starts_with(word);
  });
}

}  // namespace

std::string ColumnWords::Dimension() const { return unit ? ParseUnit(*unit).si : "1"; }

ColumnWords ReadColumnWords(const SourceColumn& source) {
  ColumnWords column;
  column.name = source.name;
  if (source.unit) {
    column.unit = UnitWord(*source.unit);
    column.unit_in_header = column.unit == source.unit;
    if (!column.unit) column.unknown_unit = *source.unit;
  }
  Words pieces = Pieces(source.name);
  const std::optional<std::string> named = TakeUnit(pieces);
  if (!source.unit) column.unit = named;
  Words words;
  for (const std::string& piece : pieces) {
    for (std::string& word : Split(piece)) words.push_back(std::move(word));
  }
  Sort(words, column);
  const std::string dimension = column.Dimension();
  if (const auto quantity = QuantityOf(dimension)) {
    // A word that was taken for another quantity says a place: t of "t1 [N]".
    if (column.quantity != *quantity && column.quantity != Quantity::kUnknown) {
      for (const std::string& word : words) {
        const auto found = Quantities().find(word);
        if (found == Quantities().end() || found->second == *quantity) continue;
        if (!Roles().contains(word)) column.place.words.push_back(word);
      }
    }
    column.quantity = *quantity;
  } else if (dimension != "1") {
    column.quantity = Quantity::kUnknown;
    column.role = ColumnRole::kOther;
  }
  return column;
}

PlaceWords ReadPlaceWords(const std::string& name) {
  ColumnWords words;
  for (const std::string& piece : Pieces(name)) Sort(Split(piece), words);
  return words.place;
}

std::string Squeezed(const std::string& name) {
  std::string squeezed;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) continue;
    squeezed += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return squeezed;
}

double Agreement(const PlaceWords& column, const PlaceWords& element) {
  constexpr double kNothingSaid = 0.3;
  constexpr double kGeneric = 0.5;  // the weight of a word that many names have
  const auto size = [](const PlaceWords& place) {
    return static_cast<double>(place.words.size() + place.numbers.size()) +
           kGeneric * static_cast<double>(place.generic.size());
  };
  const auto bare = [](const PlaceWords& place) {
    return place.words.empty() && place.numbers.empty();
  };
  double common = 0.0;
  for (const int number : column.numbers) {
    if (std::ranges::find(element.numbers, number) != element.numbers.end()) {
      common += 1.0;
    }
  }
  if (!column.numbers.empty() && !element.numbers.empty() && common == 0.0) return -1.0;
  if (bare(column) || bare(element)) {
    return bare(column) && bare(element) ? kNothingSaid + 0.1 : kNothingSaid;
  }
  for (const std::string& word : column.words) {
    if (Contains(element.words, word)) common += 1.0;
  }
  for (const std::string& word : column.generic) {
    if (Contains(element.generic, word)) common += kGeneric;
  }
  return 2.0 * common / (size(column) + size(element));
}

}  // namespace mjdiag
