#include "mjdiag/plugin/draft/draft_description.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

class Description {
 public:
  Description(const MatchedLog& matched, SetupDraft& draft)
      : matched_(matched), draft_(draft) {}

  void Write() {
    AskForWhatIsMissing();
    AskForSwitches();
    Explain();
  }

 private:
  const ColumnWords& Column(std::size_t c) const { return matched_.log.columns[c]; }

  std::vector<std::string> NamesOf(const std::vector<std::size_t>& columns) const {
    std::vector<std::string> names;
    for (const std::size_t c : columns) names.push_back(Quoted(Column(c).name));
    return names;
  }

  /// Columns that may be of several places, or several that may be of one.
  template <typename Place>
  void AskForOpen(const std::vector<Place>& places,
                  const std::vector<ColumnChoice>& choices, const std::string& kind) {
    std::map<std::vector<std::size_t>, std::vector<std::string>> open;
    for (std::size_t p = 0; p < places.size(); ++p) {
      if (choices[p].column || choices[p].others.empty()) continue;
      open[choices[p].others].push_back(Quoted(places[p].element));
    }
    for (const auto& [columns, elements] : open) {
      draft_.questions.push_back("which column is the " + kind + " of " +
                                 Listed(elements) + ": " + Listed(NamesOf(columns)) +
                                 "? Nothing in the log tells");
    }
  }

  std::vector<std::string> NotUnderstood() const {
    std::vector<std::string> names;
    for (const ColumnWords& column : matched_.log.columns) {
      if (column.quantity == Quantity::kUnknown) names.push_back(Quoted(column.name));
    }
    return names;
  }

  void AskForWhatIsMissing() {
    AskForOpen(matched_.readings, matched_.of_readings, "position");
    AskForOpen(matched_.drives, matched_.of_drives, "input");
    const std::vector<std::string> unknown = NotUnderstood();
    const std::string perhaps =
        unknown.empty() ? "" : "; names that say nothing: " + Listed(unknown);
    const auto no_others = [](const ColumnChoice& choice) {
      return choice.others.empty();
    };
    if (draft_.sensors.empty() &&
        std::ranges::all_of(matched_.of_readings, no_others)) {
      draft_.questions.push_back("no column is a position of the plant" + perhaps);
    }
    if (draft_.actuators.empty() &&
        std::ranges::all_of(matched_.of_drives, no_others)) {
      draft_.questions.push_back("no column drives the plant" + DrivesThatCannot() +
                                 perhaps);
    }
  }

  /// A motor that was off for a while gave no force, and not that of a command 0.
  void AskForSwitches() {
    for (const ColumnWords& column : matched_.log.columns) {
      if (!column.switches || draft_.actuators.empty()) continue;
      const std::optional<Record> record = RawColumns(matched_.log, {column.name});
      if (!record) continue;
      const Eigen::VectorXd& values = record->At(column.name).samples;
      if ((values.array() != 0.0).all() || (values.array() == 0.0).all()) continue;
      draft_.questions.push_back(
          Quoted(column.name) +
          " is 0 for a part of the log: if a motor was off then, write it as a "
          "channel " +
          "under record.channels and name that under actuators.<channel>.enabled_by");
    }
  }

  /// Amperes and volts beside a joint without a motor.
  std::string DrivesThatCannot() const {
    for (const ColumnWords& column : matched_.log.columns) {
      const std::string unit = column.Dimension();
      if (column.role == ColumnRole::kOther || (unit != "A" && unit != "V")) continue;
      return ": " + Quoted(column.name) + " is in " + unit +
             ", and no motor of the plant says what force that is (<motor gear>)";
    }
    return "";
  }

  void Explain() {
    std::vector<std::string> ordered;
    for (std::size_t p = 0; p < matched_.readings.size(); ++p) {
      ExplainChoice(matched_.of_readings[p], matched_.readings[p].element, ordered);
    }
    for (std::size_t p = 0; p < matched_.drives.size(); ++p) {
      ExplainChoice(matched_.of_drives[p], matched_.drives[p].element, ordered);
    }
    if (!ordered.empty()) {
      draft_.assumed.push_back(
          "numbered columns are of joints in the order of the plant: " +
          Listed(ordered));
    }
    std::vector<std::string> idle;
    for (std::size_t p = 0; p < matched_.drives.size(); ++p) {
      if (matched_.drives[p].actuator >= 0 && !matched_.of_drives[p].column) {
        idle.push_back(Quoted(matched_.drives[p].element));
      }
    }
    if (!idle.empty()) {
      draft_.notes.push_back("no column drives " + Few(idle) + ": 0 all the time");
    }
    std::vector<std::string> unread;
    for (std::size_t p = 0; p < matched_.readings.size(); ++p) {
      const Reading& reading = matched_.readings[p];
      if (reading.joint < 0 || reading.quantity != Quantity::kPosition) continue;
      if (!matched_.of_readings[p].column) {
        unread.push_back(Quoted(reading.joint_name));
      }
    }
    if (!unread.empty()) {
      draft_.notes.push_back("no column is the position of " + Few(unread));
    }
    ExplainUnused();
  }

  void ExplainChoice(const ColumnChoice& choice, const std::string& element,
                     std::vector<std::string>& ordered) {
    if (!choice.column) return;
    const std::string column = Quoted(Column(*choice.column).name);
    if (choice.by_order) ordered.push_back(column + " of " + Quoted(element));
    if (choice.by_elimination) {
      draft_.assumed.push_back(column + " is of " + Quoted(element) +
                               ": neither can be anything else");
    }
    if (!choice.others.empty()) {
      draft_.assumed.push_back(column + " is of " + Quoted(element) + ", and not " +
                               Listed(NamesOf(choice.others)));
    }
  }

  void ExplainUnused() {
    std::set<std::string> used;
    for (const auto* channels : {&draft_.sensors, &draft_.actuators}) {
      for (const DraftedChannel& channel : *channels) used.insert(channel.column);
    }
    std::set<std::string> behind;
    for (const auto* choices : {&matched_.of_readings, &matched_.of_drives}) {
      for (const ColumnChoice& choice : *choices) {
        for (const std::size_t c : choice.others) behind.insert(Column(c).name);
      }
    }
    std::map<std::string, std::vector<std::string>> reasons;
    for (const ColumnWords& column : matched_.log.columns) {
      if (used.contains(column.name)) continue;
      const std::string reason = behind.contains(column.name)
                                     ? "another column goes before it"
                                     : WhyUnused(column);
      reasons[reason].push_back(Quoted(column.name));
    }
    for (const auto& [reason, names] : reasons) {
      draft_.unused.push_back(Few(names) + ": " + reason);
    }
  }

  /// "a, b, c and 9 more".
  static std::string Few(std::vector<std::string> names) {
    constexpr std::size_t kShown = 6;
    if (names.size() <= kShown + 1) return Listed(names);
    const std::string more = std::to_string(names.size() - kShown);
    names.resize(kShown);
    return Listed(names) + " and " + more + " more";
  }

  /// A sensor of several numbers that is called as the column is.
  bool IsOneOfAVector(const std::string& name) const {
    return std::ranges::any_of(matched_.readings, [&](const Reading& reading) {
      return reading.component > 0 && reading.element == name;
    });
  }

  std::string WhyUnused(const ColumnWords& column) const {
    if (IsOneOfAVector(column.name)) {
      return "which number of its sensor is not said: name it '" + column.name +
             "_x', _y or _z";
    }
    if (column.switches) {
      return "says when a motor is on, if actuators.<channel>.enabled_by names it";
    }
    if (column.role == ColumnRole::kReference) return "what was wanted, for [axes]";
    if (column.role == ColumnRole::kOther) return "no channel of an open-loop setup";
    switch (column.quantity) {
      case Quantity::kVelocity:
        return "speed, beside a position or without a sensor";
      case Quantity::kAcceleration:
        return "acceleration, without a sensor of that name";
      case Quantity::kUnknown:
        return "the name says nothing of the plant";
      default:
        return "nothing of the plant is called so";
    }
  }

  const MatchedLog& matched_;
  SetupDraft& draft_;
};

}  // namespace

std::string Quoted(const std::string& name) { return "'" + name + "'"; }

void DescribeDraft(const MatchedLog& matched, SetupDraft& draft) {
  Description(matched, draft).Write();
}

}  // namespace mjdiag
