#include <algorithm>
#include <cctype>
#include <utility>

#include "mjdiag/plugin/draft/log_draft.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

bool IsUsed(const SetupDraft& draft, const std::string& channel) {
  const auto same = [&](const DraftedChannel& other) {
    return other.channel == channel;
  };
  return std::ranges::any_of(draft.sensors, same) ||
         std::ranges::any_of(draft.actuators, same);
}

/// Letters, digits and _, a letter first: "q[0]" -> "q_0".
std::string ChannelName(const SetupDraft& draft, const std::string& column) {
  std::string name;
  for (const char c : column) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 && (c & 0x80) == 0;
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
    name = "c" + name;
  }
  if (name == "time") name = "time_";
  std::string unique = name;
  for (int i = 2; IsUsed(draft, unique); ++i) unique = name + "_" + std::to_string(i);
  return unique;
}

bool IsNameless(const mjModel& model, mjtObj kind, int id) {
  const char* name = mj_id2name(&model, kind, id);
  return name == nullptr || name[0] == '\0';
}

std::string Joint(const mjModel& model, int joint, SetupDraft& draft) {
  std::vector<int>& named = draft.additions.named_joints;
  if (IsNameless(model, mjOBJ_JOINT, joint) &&
      std::ranges::find(named, joint) == named.end()) {
    named.push_back(joint);
    draft.added.push_back("the name '" + GivenName(model, mjOBJ_JOINT, joint) +
                          "' of a joint that has none");
  }
  return GivenName(model, mjOBJ_JOINT, joint);
}

DraftedChannel ChannelOf(const ColumnWords* column, const std::string& unit,
                         const std::string& fallback, const SetupDraft& draft) {
  DraftedChannel channel;
  channel.channel = ChannelName(draft, column != nullptr ? column->name : fallback);
  if (column == nullptr) return channel;
  channel.column = column->name;
  if (column->unit_in_header) return channel;
  channel.column_unit = column->unit ? *column->unit : unit;
  return channel;
}

}  // namespace

void AddSensor(const mjModel& model, const Reading& reading, const ColumnWords* column,
               const std::string& unit, SetupDraft& draft) {
  DraftedChannel channel = ChannelOf(column, unit, reading.element, draft);
  channel.element = reading.element;
  channel.component = reading.component;
  channel.unit = reading.unit;
  if (!reading.exists) {
    const std::string joint = Joint(model, reading.joint, draft);
    channel.element = FreeName(model, mjOBJ_SENSOR, joint);
    draft.additions.sensors.push_back({channel.element, joint});
    draft.added.push_back("<jointpos name=\"" + channel.element + "\" joint=\"" +
                          joint + "\"/>");
  }
  draft.sensors.push_back(std::move(channel));
}

void AddActuator(const mjModel& model, const Drive& drive, const ColumnWords* column,
                 const std::string& unit, SetupDraft& draft) {
  const bool read = IsUsed(draft, drive.element);
  DraftedChannel channel =
      ChannelOf(column, unit, drive.element + (read ? "_input" : ""), draft);
  channel.element = drive.element;
  channel.unit = drive.unit;
  if (column != nullptr && column->unit) channel.unit = column->Dimension();
  if (drive.actuator < 0) {
    const std::string joint = Joint(model, drive.joint, draft);
    channel.element = FreeName(model, mjOBJ_ACTUATOR, joint);
    draft.additions.motors.push_back({channel.element, joint});
    draft.added.push_back("<motor name=\"" + channel.element + "\" joint=\"" + joint +
                          "\"/>");
  } else if (IsNameless(model, mjOBJ_ACTUATOR, drive.actuator)) {
    draft.additions.named_actuators.push_back(drive.actuator);
    draft.added.push_back("the name '" + drive.element +
                          "' of an actuator that has none");
  }
  draft.actuators.push_back(std::move(channel));
}

}  // namespace mjdiag
