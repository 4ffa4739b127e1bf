#include <fstream>
#include <sstream>

#include "mjdiag/plugin/draft/setup_draft.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/folder_update.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// A text as TOML has it.
std::string TomlString(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + "\"";
}

void AddComments(const std::string& title, const std::vector<std::string>& lines,
                 std::string& text) {
  if (lines.empty()) return;
  text += "# " + title + "\n";
  for (std::string line : lines) {
    for (char& c : line) {
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    text += "#   " + line + "\n";
  }
}

std::string Column(const std::string& name, const std::string& unit) {
  std::string text = "{ column = " + TomlString(name);
  if (!unit.empty()) text += ", unit = " + TomlString(unit);
  return text + " }\n";
}

void AddRecord(const SetupDraft& draft, std::string& text) {
  if (draft.record.empty() || (draft.sensors.empty() && draft.actuators.empty()))
    return;
  text += "\n[record]\n";
  if (!draft.time_column.empty()) {
    text += "time = " + Column(draft.time_column, draft.time_unit);
  }
  text += "\n[record.channels]\n";
  for (const auto* channels : {&draft.sensors, &draft.actuators}) {
    for (const DraftedChannel& channel : *channels) {
      text += channel.channel + " = " + Column(channel.column, channel.column_unit);
    }
  }
}

std::string PlantPath(const fs::path& plant, const fs::path& folder) {
  const fs::path target = fs::weakly_canonical(plant);
  return target.lexically_relative(fs::weakly_canonical(folder)).generic_string();
}

}  // namespace

std::string DraftText(const SetupDraft& draft, const std::string& plant) {
  std::string text;
  AddComments("Could not be told:", draft.questions, text);
  AddComments("Assumed:", draft.assumed, text);
  AddComments("Added to the plant:", draft.added, text);
  AddComments("Of the log, not used:", draft.unused, text);
  AddComments("Notes:", draft.notes, text);
  if (!text.empty()) text += "\n";
  text += "schema = \"mjdiag.setup/1\"\nname = " + TomlString(draft.name) +
          "\nplant = " + TomlString(plant) +
          "\n\n[rates]\ncontrol = " + AllDigits(draft.control) +
          "\nsubsteps = " + std::to_string(draft.substeps) + "\n";
  for (const DraftedChannel& sensor : draft.sensors) {
    text +=
        "\n[sensors." + sensor.channel + "]\nelement = " + TomlString(sensor.element);
    if (sensor.component > 0) {
      text += "\ncomponent = " + std::to_string(sensor.component);
    }
    text += "\nunit = " + TomlString(sensor.unit) + "\n";
  }
  for (const DraftedChannel& actuator : draft.actuators) {
    text += "\n[actuators." + actuator.channel +
            "]\nelement = " + TomlString(actuator.element) +
            "\nunit = " + TomlString(actuator.unit) + "\n";
  }
  AddRecord(draft, text);
  return text;
}

void WriteDraft(const SetupDraft& draft, const SourcePlant& source,
                const fs::path& folder) {
  FolderUpdate update;
  std::string plant = PlantPath(draft.plant, folder);
  if (draft.additions.any()) {
    plant = "plant.xml";
    WriteTextFile(folder / plant,
                  PlantWith(draft.plant, source, draft.additions, folder));
  }
  WriteTextFile(folder / "setup.toml", DraftText(draft, plant));
  update.Commit();
}

}  // namespace mjdiag
