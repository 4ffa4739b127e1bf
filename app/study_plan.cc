#include "app/study_plan.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "app/command.h"
#include "app/interrupt.h"
#include "app/plan_log.h"
#include "app/study_answer.h"
#include "app/study_log.h"
#include "mjdiag/report/study_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/cluster/rank_launch.h"
#include "mjdiag/studies/dataset/plan_run.h"
#include "mjdiag/studies/dataset/plan_tables.h"

namespace mjdiag::app {
namespace {

NamedPage PlanPage(const StudyPlan& plan, const std::string& setup,
                   const std::vector<StudyTable>& tables) {
  StudyFacts facts{setup, plan.name, static_cast<int>(plan.Runs()), plan.seed};
  facts.is_plan = true;
  const RunDescription run{CommandLine(), "", {{"mjdiag", MJDIAG_VERSION}}};
  return {"study", StudyPage(facts, tables, run)};
}

nlohmann::json DocumentOf(const LoadedPlan& loaded, const PlanOutcome& outcome) {
  nlohmann::json document{
      {"schema", "mjdiag.study/1"}, {"setup", loaded.machine.setup().name},
      {"plan", loaded.plan.name},   {"runs", loaded.plan.Runs()},
      {"seed", loaded.plan.seed},   {"linear", loaded.plan.linear},
      {"command", CommandLine()},   {"dataset", nullptr}};
  if (outcome.dataset) document["dataset"] = outcome.dataset->filename().string();
  return document;
}

/// What became of the files.
std::string FilesText(const PlanOutcome& outcome) {
  std::string text = "\n" + ProgressText(outcome.progress);
  if (outcome.progress.found > 0) {
    text += ", " + std::to_string(outcome.progress.found) + " of which were there";
  }
  text += "\n";
  if (outcome.dataset) return text + "data set: " + outcome.dataset->string() + "\n";
  return text + "no data set: built without HDF5 (libhdf5-dev)\n";
}

}  // namespace

bool IsSilentRank(int argc, char** argv) {
  if (FindLaunch().rank == 0 || argc < 2 || std::string_view(argv[1]) != "study") {
    return false;
  }
  return std::any_of(argv + 2, argv + argc, [](std::string_view word) {
    return word == "--plan" || word.starts_with("--plan=");
  });
}

void RunPlanFile(const PlanCommand& command, const OutputOptions& output) {
  // Before anything can go wrong: what does is said once.
  std::optional<RankTeam> team;
  if (auto link = JoinLaunch()) team.emplace(std::move(link));
  PlanRunOptions options;
  options.folder = output.folder;
  options.restart = command.restart;
  options.threads = command.threads;
  options.patience = command.patience;
  if (team) options.team = &*team;
  if (team && !team->is_led_here()) {
    const Interrupt interrupt;
    options.progress = [](const PlanProgress&) { Interrupt::ThrowIfWished(); };
    ServePlan(command.file, options);
    return;
  }
  const LoadedPlan loaded = ReadPlan(command.file);
  if (loaded.plan.ask) {
    if (team) {
      throw InputError(command.file, "asks what one process answers", "no other ranks");
    }
    const auto runs = static_cast<int>(loaded.plan.Runs());
    AnswerPlan(loaded, {"plan", loaded.plan.name, runs, loaded.plan.linear}, output);
    return;
  }
  if (output.folder.empty()) {
    throw InputError("--out", "is missing", "a folder for the runs of the plan");
  }
  PrepareOutput(output);
  const Interrupt interrupt;
  PlanLog log(output.folder);
  options.note = [&log](const std::string& line) { log.Note(line); };
  options.progress = [&log](const PlanProgress& progress) {
    log.Show(progress);
    Interrupt::ThrowIfWished();
  };
  const PlanOutcome outcome = RunPlan(loaded, options);
  log.End(outcome.progress);
  const std::vector<StudyTable> tables = PlanTables(outcome);
  StudyLog tables_log(output, DocumentOf(loaded, outcome), "study");
  Publish(output, "study", tables_log.Document(tables, true),
          tables_log.RestOf(tables) + FilesText(outcome),
          [&] { return PlanPage(loaded.plan, loaded.machine.setup().name, tables); });
}

}  // namespace mjdiag::app
