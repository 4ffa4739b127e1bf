// mjdiag study: sweeps and Monte-Carlo studies with their tables.

#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "app/command.h"
#include "app/format.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/report/study_page.h"
#include "mjdiag/studies/bound_study.h"
#include "mjdiag/studies/classification_study.h"
#include "mjdiag/studies/detection_study.h"
#include "mjdiag/studies/disturbance_study.h"
#include "mjdiag/studies/estimation_study.h"
#include "mjdiag/studies/hidden_table.h"
#include "mjdiag/studies/tolerance_study.h"

namespace mjdiag::app {
namespace {

struct StudyCommand {
  MachineOptions machine;
  OutputOptions output;
  std::string preset;
  int runs = 200;
  std::uint64_t seed = 1;
};

using Study =
    std::function<std::vector<StudyTable>(const Machine&, const StudyOptions&)>;

template <int causes>
std::vector<StudyTable> HiddenEffects(const Machine& machine,
                                      const StudyOptions& options) {
  return HiddenStudy(machine, causes, options);
}

/// Preset -> study, and what it is for.
const std::map<std::string, Study>& Studies() {
  static const std::map<std::string, Study> studies{
      {"table2", LinearDetectionStudy},
      {"table3",
       [](const Machine& machine, const StudyOptions& options) {
         return NonlinearDetectionStudy(machine, "table3", false, options);
       }},
      {"table4", ClassificationStudy},
      {"table5",
       [](const Machine& machine, const StudyOptions& options) {
         return NonlinearDetectionStudy(machine, "table5", true, options);
       }},
      {"estimation", EstimationStudy},
      {"disturbance", DisturbanceStudy},
      {"bound", BoundStudy},
      {"tolerance", ToleranceStudy},
      {"hidden", HiddenEffects<1>},
      {"hidden_none", HiddenEffects<0>},
      {"hidden_two", HiddenEffects<2>}};
  return studies;
}

nlohmann::json ToJson(const Cell& cell) {
  if (!cell.is_number) return cell.text;
  return std::isfinite(cell.number) ? nlohmann::json(cell.number) : nlohmann::json();
}

nlohmann::json ToJson(const StudyTable& table) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& cells : table.rows) {
    nlohmann::json row = nlohmann::json::array();
    for (const Cell& cell : cells) row.push_back(ToJson(cell));
    rows.push_back(row);
  }
  return {{"title", table.title},
          {"columns", table.columns},
          {"rows", rows},
          {"notes", table.notes}};
}

std::string ToText(const StudyTable& table) {
  Table text(table.columns);
  for (const auto& cells : table.rows) {
    std::vector<std::string> row;
    row.reserve(cells.size());
    for (const Cell& cell : cells) row.push_back(cell.text);
    text.Add(row);
  }
  std::string result = table.title + "\n\n" + text.ToString();
  for (const std::string& note : table.notes) result += "\n" + note;
  return result + (table.notes.empty() ? "\n" : "\n\n");
}

NamedPage StudyPageOf(const StudyCommand& command, const std::string& setup,
                      const std::vector<StudyTable>& tables) {
  const StudyFacts facts{setup, command.preset, command.runs, command.seed};
  const RunDescription run{CommandLine(), "", {{"mjdiag", MJDIAG_VERSION}}};
  return {"study", StudyPage(facts, tables, run)};
}

void RunStudy(const StudyCommand& command) {
  const Machine machine = LoadSubject(command.machine).nominal;
  PrepareOutput(command.output);
  StudyOptions options{command.runs, command.seed, {}};
  nlohmann::json document{{"schema", "mjdiag.study/1"},
                          {"setup", machine.setup().name},
                          {"preset", command.preset},
                          {"runs", command.runs},
                          {"seed", command.seed},
                          {"command", CommandLine()},
                          {"tables", nlohmann::json::array()}};
  std::string text;
  std::vector<StudyTable> tables;
  {
    ProgressBar bar("study " + command.preset);
    options.progress = [&bar](double fraction) { bar.Show(fraction); };
    tables = Studies().at(command.preset)(machine, options);
  }
  for (const StudyTable& table : tables) {
    document["tables"].push_back(ToJson(table));
    text += ToText(table);
  }
  Publish(command.output, "study", document, text,
          [&] { return StudyPageOf(command, machine.setup().name, tables); });
}

}  // namespace

void AddStudy(CLI::App& app) {
  auto options = std::make_shared<StudyCommand>();
  CLI::App* command = app.add_subcommand("study", "Run a study with its tables");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  std::vector<std::string> presets;
  for (const auto& [name, study] : Studies()) presets.push_back(name);
  command->add_option("--preset", options->preset, "Which study")
      ->required()
      ->check(CLI::IsMember(presets));
  command->add_option("--runs", options->runs, "Monte-Carlo runs")
      ->check(CLI::Range(2, 1000000));
  command->add_option("--seed", options->seed, "Seed of the first run");
  command->callback([options] { RunStudy(*options); });
}

}  // namespace mjdiag::app
