#include "app/discovery_output.h"

#include <algorithm>
#include <filesystem>

#include "app/format.h"
#include "mjdiag/plugin/extension/effects_file.h"
#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/report/discovery_text.h"
#include "mjdiag/report/kinds_text.h"
#include "mjdiag/report/mismatch_tables.h"

namespace mjdiag::app {
namespace {

/// A table of the page under its heading; nothing without rows.
std::string Section(const std::string& heading, const mjdiag::Table& content) {
  if (content.rows.empty()) return "";
  std::vector<std::string> header;
  for (const auto& column : content.columns) header.push_back(column.title);
  Table table(header);
  for (const std::vector<std::string>& row : content.rows) table.Add(row);
  return "\n" + heading + "\n\n" + table.ToString();
}

std::string NotesText(const std::vector<std::string>& notes) {
  if (notes.empty()) return "";
  std::string text = "\nNotes\n\n";
  for (const std::string& note : notes) text += "- " + note + "\n";
  return text;
}

}  // namespace

std::string DiscoveryAsText(const Discovery& discovery) {
  return DiscoveryAnswer(discovery) + "\n" +
         Section("Kinds of physics", KindTable(discovery)) +
         Section("Causes", CauseTable(discovery)) +
         Section("What resists a joint, all laws together",
                 ResistanceTable(discovery)) +
         Section("Explanations", ExplanationTable(discovery)) +
         Section("Numbers of the plant", CalibrationTable(discovery)) +
         Section("Masses and where they are", MomentTable(discovery)) +
         Section("After each cause", LadderTable(discovery)) +
         Section("After each cause, on the validation record",
                 ValidationLadderTable(discovery)) +
         Section("Mismatch, rms", MismatchTable(discovery)) +
         Section("Every record, free simulation", RecordTable(discovery)) +
         Section("Smallest faults that are seen", FaultLimitTable(discovery)) +
         NotesText(discovery.notes);
}

std::string WriteExtendedPlant(const std::string& folder, const std::string& setup,
                               const Machine& machine, const Discovery& discovery) {
  if (!HasFound(discovery)) return "";
  return WriteExtendedSetup(std::filesystem::path(folder) / "extended", setup,
                            machine.WithSubsteps(discovery.substeps),
                            ChangesOfAnswer(discovery))
      .string();
}

void RemoveExtendedPlant(const std::string& folder, const std::string& setup) {
  namespace fs = std::filesystem;
  const fs::path extended = fs::path(folder) / "extended";
  fs::path given = setup;
  if (!fs::is_directory(given)) given = given.parent_path();
  std::error_code none;
  if (!fs::exists(extended / "plant.xml", none) ||
      !fs::exists(extended / "setup.toml", none) ||
      fs::equivalent(extended, given, none)) {
    return;
  }
  for (const char* file : {"plant.xml", "setup.toml"})
    fs::remove(extended / file, none);
  RemoveEffectsFile(extended);
  fs::remove(extended, none);  // where nothing else is in it
}

}  // namespace mjdiag::app
