#include "mjdiag/plugin/draft/log_draft.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "mjdiag/plugin/draft/draft_description.h"
#include "mjdiag/plugin/draft/log_physics.h"
#include "mjdiag/plugin/draft/name_match.h"
#include "mjdiag/plugin/draft/open_choice.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

// A joint may be behind its range by a stop that gives, a command by one that is cut off.
constexpr double kBeyondRange = 1.5;

struct UnitOption {
  std::string unit;
  double factor;
};

std::vector<UnitOption> UnitsOf(const std::string& si) {
  if (si == "rad") return {{"rad", 1.0}, {"deg", std::numbers::pi / 180.0}};
  if (si == "m") return {{"m", 1.0}, {"mm", 1e-3}};
  if (si == "rad/s") return {{"rad/s", 1.0}, {"deg/s", std::numbers::pi / 180.0}};
  if (si == "1") return {{"1", 1.0}};
  return {{si, 1.0}, {"m" + si, 1e-3}};
}

class Drafter {
 public:
  Drafter(const mjModel& model, const LogColumns& log, SetupDraft& draft)
      : model_(model),
        log_(log),
        draft_(draft),
        readings_(PlantReadings(model)),
        drives_(PlantDrives(model)),
        columns_of_readings_(MatchReadings(readings_, log.columns)),
        columns_of_drives_(MatchDrives(drives_, log.columns, Taken())) {}

  void Draft() {
    if (log_.time) {
      draft_.time_column = log_.time->name;
      if (!log_.time->unit_in_header) draft_.time_unit = *log_.time->unit;
    }
    Append(log_.assumed, draft_.assumed);
    Append(log_.questions, draft_.questions);
    const LogPhysics physics(model_, log_, Candidates());
    Decide(physics);
    AddChannels();
    DescribeDraft({log_, readings_, drives_, columns_of_readings_, columns_of_drives_},
                  draft_);
    CheckAgainstForces(physics);
  }

 private:
  static void Append(const std::vector<std::string>& from,
                     std::vector<std::string>& to) {
    to.insert(to.end(), from.begin(), from.end());
  }
  const ColumnWords& Column(std::size_t c) const { return log_.columns[c]; }
  bool HasUnit(std::size_t c) const { return Column(c).unit.has_value(); }

  std::vector<bool> Taken() const {
    std::vector<bool> taken(log_.columns.size(), false);
    for (const ColumnChoice& choice : columns_of_readings_) {
      if (choice.column) taken[*choice.column] = true;
      if (!choice.column) {
        for (const std::size_t c : choice.others) taken[c] = true;
      }
    }
    return taken;
  }

  std::vector<std::size_t> Candidates() const {
    std::vector<std::size_t> candidates;
    for (const auto* choices : {&columns_of_readings_, &columns_of_drives_}) {
      for (const ColumnChoice& choice : *choices) {
        if (choice.column) candidates.push_back(*choice.column);
        if (!choice.column) Append(choice.others, candidates);
      }
    }
    return candidates;
  }
  static void Append(const std::vector<std::size_t>& from,
                     std::vector<std::size_t>& to) {
    to.insert(to.end(), from.begin(), from.end());
  }

  double FactorOf(std::size_t c) const {
    if (HasUnit(c)) return ParseUnit(*Column(c).unit).factor;
    const auto unit = units_.find(c);
    return unit == units_.end() ? 1.0 : ParseUnit(unit->second).factor;
  }

  /// What is known so far.
  LogReading Known() const {
    LogReading known;
    for (std::size_t p = 0; p < readings_.size(); ++p) {
      const Reading& reading = readings_[p];
      const ColumnChoice& choice = columns_of_readings_[p];
      if (reading.joint < 0 || reading.quantity != Quantity::kPosition) continue;
      if (choice.column) {
        known.joints[reading.joint] = {*choice.column, FactorOf(*choice.column)};
      }
    }
    for (std::size_t p = 0; p < drives_.size(); ++p) {
      const ColumnChoice& choice = columns_of_drives_[p];
      if (!choice.column) continue;
      const ScaledColumn scaled{*choice.column, FactorOf(*choice.column)};
      if (drives_[p].actuator >= 0) {
        known.motors[drives_[p].actuator] = scaled;
      } else {
        known.forces[drives_[p].joint] = scaled;
      }
    }
    return known;
  }

  /// Whether a place can be where the column says, in that unit.
  bool IsWithinRange(const LogPhysics& physics, std::size_t c, double factor,
                     const mjtNum* range) const {
    const std::optional<double> largest = physics.Largest(c);
    if (!largest) return true;
    const double most = std::max(std::abs(range[0]), std::abs(range[1]));
    return *largest * factor <= kBeyondRange * most;
  }

  /// Units of columns that say none: those of one quantity have one unit in a log.
  std::vector<OpenChoice> UnitChoices(const LogPhysics& physics) {
    std::map<std::string, std::vector<std::size_t>> groups;
    std::map<std::size_t, const mjtNum*> ranges;
    for (std::size_t p = 0; p < readings_.size(); ++p) {
      const ColumnChoice& choice = columns_of_readings_[p];
      if (!choice.column || HasUnit(*choice.column)) continue;
      groups[readings_[p].unit].push_back(*choice.column);
      const int joint = readings_[p].joint;
      if (joint >= 0 && model_.jnt_limited[joint] != 0 &&
          readings_[p].quantity == Quantity::kPosition) {
        ranges[*choice.column] = RowOf(model_.jnt_range, 2, joint);
      }
    }
    for (std::size_t p = 0; p < drives_.size(); ++p) {
      const ColumnChoice& choice = columns_of_drives_[p];
      if (!choice.column || HasUnit(*choice.column)) continue;
      groups[drives_[p].unit].push_back(*choice.column);
      const int motor = drives_[p].actuator;
      if (motor >= 0 && model_.actuator_ctrllimited[motor] != 0) {
        ranges[*choice.column] = RowOf(model_.actuator_ctrlrange, 2, motor);
      }
    }
    std::vector<OpenChoice> choices;
    for (const auto& [si, columns] : groups) {
      OpenChoice choice;
      std::vector<std::string> names;
      for (const std::size_t c : columns) names.push_back(Quoted(Column(c).name));
      choice.what = Listed(names);
      for (const UnitOption& option : UnitsOf(si)) {
        const auto apply = [columns = columns, option](LogReading& reading) {
          for (auto* places : {&reading.joints, &reading.motors, &reading.forces}) {
            for (auto& [place, scaled] : *places) {
              if (std::ranges::find(columns, scaled.column) == columns.end()) continue;
              scaled.factor = option.factor;
            }
          }
        };
        const bool possible = std::ranges::all_of(columns, [&](std::size_t c) {
          const auto range = ranges.find(c);
          return range == ranges.end() ||
                 IsWithinRange(physics, c, option.factor, range->second);
        });
        choice.options.push_back({option.unit, apply, possible});
      }
      unit_groups_.push_back(columns);
      choices.push_back(std::move(choice));
    }
    return choices;
  }

  /// Motors and joints of which names leave several columns open.
  void AddColumnChoices(std::vector<OpenChoice>& choices) {
    for (std::size_t p = 0; p < readings_.size(); ++p) {
      const ColumnChoice& open = columns_of_readings_[p];
      const int joint = readings_[p].joint;
      if (open.column || open.others.size() < 2 || joint < 0) continue;
      if (readings_[p].quantity != Quantity::kPosition) continue;
      OpenChoice choice;
      choice.what =
          "position of joint " + Quoted(GivenName(model_, mjOBJ_JOINT, joint));
      for (const std::size_t c : open.others) {
        const auto apply = [joint, scaled = ScaledColumn{c, FactorOf(c)}](
                               LogReading& reading) { reading.joints[joint] = scaled; };
        choice.options.push_back({Quoted(Column(c).name), apply, true});
      }
      open_readings_.emplace_back(choices.size(), p);
      choices.push_back(std::move(choice));
    }
    for (std::size_t p = 0; p < drives_.size(); ++p) {
      const ColumnChoice& open = columns_of_drives_[p];
      const int motor = drives_[p].actuator;
      if (open.column || open.others.size() < 2 || motor < 0) continue;
      OpenChoice choice;
      choice.what = "input of actuator " + Quoted(drives_[p].element);
      for (const std::size_t c : open.others) {
        const auto apply = [motor, scaled = ScaledColumn{c, FactorOf(c)}](
                               LogReading& reading) { reading.motors[motor] = scaled; };
        choice.options.push_back({Quoted(Column(c).name), apply, true});
      }
      open_drives_.emplace_back(choices.size(), p);
      choices.push_back(std::move(choice));
    }
  }

  void Decide(const LogPhysics& physics) {
    std::vector<OpenChoice> choices = UnitChoices(physics);
    AddColumnChoices(choices);
    if (choices.empty()) return;
    DecideByForces(physics, Known(), choices);
    for (std::size_t i = 0; i < unit_groups_.size(); ++i) TakeUnit(choices[i], i);
    for (const auto& [i, p] : open_readings_) {
      TakeColumn(choices[i], columns_of_readings_[p]);
    }
    for (const auto& [i, p] : open_drives_)
      TakeColumn(choices[i], columns_of_drives_[p]);
  }

  void TakeUnit(const OpenChoice& choice, std::size_t group) {
    const std::size_t option = choice.chosen.value_or(0);
    for (const std::size_t c : unit_groups_[group]) {
      units_[c] = choice.options[option].label;
      if (Column(c).unknown_unit.empty()) continue;
      draft_.questions.push_back("column " + Quoted(Column(c).name) + " is in '" +
                                 Column(c).unknown_unit +
                                 "', which is no unit that is known: convert it");
    }
    if (choice.options.size() < 2) return;
    std::vector<std::string> labels;
    for (const OpenChoice::Option& one : choice.options) labels.push_back(one.label);
    if (!choice.chosen) {
      draft_.questions.push_back("unit of " + choice.what + ": " + labels[0] + " or " +
                                 labels[1] + "? Nothing in the log tells; write it " +
                                 "under record.channels");
      return;
    }
    draft_.assumed.push_back(
        choice.what + " in " + labels[option] + ": " +
        (choice.because.empty() ? "out of range otherwise" : choice.because));
  }

  void TakeColumn(const OpenChoice& choice, ColumnChoice& place) {
    if (!choice.chosen) return;
    place.column = place.others[*choice.chosen];
    place.others.clear();
    draft_.assumed.push_back(choice.what + " is " +
                             choice.options[*choice.chosen].label + ": " +
                             choice.because);
  }

  std::string UnitOf(std::size_t c) const {
    const auto unit = units_.find(c);
    return unit == units_.end() ? "" : unit->second;
  }

  void AddChannels() {
    for (std::size_t p = 0; p < readings_.size(); ++p) {
      const std::optional<std::size_t> c = columns_of_readings_[p].column;
      if (c) AddSensor(model_, readings_[p], &Column(*c), UnitOf(*c), draft_);
    }
    for (std::size_t p = 0; p < drives_.size(); ++p) {
      const std::optional<std::size_t> c = columns_of_drives_[p].column;
      if (c) AddActuator(model_, drives_[p], &Column(*c), UnitOf(*c), draft_);
    }
  }

  /// Signs and delays: said, never put in.
  void CheckAgainstForces(const LogPhysics& physics) {
    const LogReading known = Known();
    if (known.motors.empty() && known.forces.empty()) return;
    const std::optional<double> imbalance = physics.Imbalance(known);
    if (!imbalance) return;
    for (const auto& [motor, scaled] : known.motors) {
      LogReading turned = known;
      turned.motors[motor].factor *= -1.0;
      const std::optional<double> other = physics.Imbalance(turned);
      if (!other || *other > kBalanced || *other > kClearly * *imbalance) continue;
      draft_.questions.push_back(
          "sign of " + Quoted(Column(scaled.column).name) +
          ": forces balance the other way round; turn the gear of actuator " +
          Quoted(GivenName(model_, mjOBJ_ACTUATOR, motor)) + " round if so");
    }
    if (*imbalance > kBalanced) return;
    GuessDelay(physics, known, *imbalance);
  }

  void GuessDelay(const LogPhysics& physics, const LogReading& known,
                  double imbalance) {
    double least = imbalance;
    int best = 0;
    for (const int lag : {1, 2, 3, 4, 5, 7, 10, 14, 20}) {
      const double seconds = lag * physics.sample_time();
      if (seconds > kLongestDelay) break;
      const std::optional<double> other = physics.Imbalance(known, lag);
      if (other && *other < least) {
        least = *other;
        best = lag;
      }
    }
    if (best == 0 || least > kClearly * imbalance) return;
    draft_.notes.push_back("the motion follows the input by about " +
                           FormatQuantity(best * physics.sample_time(), "s") +
                           "; it is not put in: --effect input_delay would");
  }

  static constexpr double kClearly = 0.8;        // of a imbalance
  static constexpr double kLongestDelay = 0.05;  // [s]

  const mjModel& model_;
  const LogColumns& log_;
  SetupDraft& draft_;
  std::vector<Reading> readings_;
  std::vector<Drive> drives_;
  std::vector<ColumnChoice> columns_of_readings_;
  std::vector<ColumnChoice> columns_of_drives_;
  std::map<std::size_t, std::string> units_;  ///< of columns that say none
  std::vector<std::vector<std::size_t>> unit_groups_;
  std::vector<std::pair<std::size_t, std::size_t>> open_readings_;  ///< choice, reading
  std::vector<std::pair<std::size_t, std::size_t>> open_drives_;
};

}  // namespace

void DraftWithLog(const mjModel& model, const LogColumns& log, SetupDraft& draft) {
  Drafter(model, log, draft).Draft();
}

}  // namespace mjdiag
