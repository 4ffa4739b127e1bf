// mjdiag study: plans, those of one's own and those that ship.

#include <algorithm>
#include <memory>
#include <string_view>

#include "app/command.h"
#include "app/output.h"
#include "app/study_answer.h"
#include "app/study_plan.h"
#include "app/subject.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/studies/preset/preset_plan.h"

namespace mjdiag::app {
namespace {

constexpr double kLongestEndurance = 1e7;  // s
constexpr double kLeastPatience = 2.0;     // s; ranks are heard every second
constexpr int kMostThreads = 4096;

struct StudyCommand {
  PlanCommand plan;
  MachineOptions machine;
  OutputOptions output;
  std::string preset;
  int runs = 200;
  std::uint64_t seed = 1;
  bool linear = false;
  double duration = 0.0;
  double every = 60.0;
  std::vector<std::string> wear;
};

/// <name>=<value>
std::pair<std::string, double> ParseWear(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const auto growth =
      ParseNumber(std::string_view(text).substr(std::min(equals + 1, text.size())));
  if (!growth) {
    throw InputError("--wear " + text, "no number behind '='",
                     "<name>=<growth an hour>");
  }
  return {text.substr(0, equals), *growth};
}

/// Whether a study has a meaning on the linear plant and on the nonlinear one.
bool TakesEitherPlant(const PlanAsk& ask) {
  return std::holds_alternative<AskNames>(ask) ||
         std::holds_alternative<AskCalibration>(ask) ||
         std::holds_alternative<AskEndurance>(ask);
}

/// What the options say in the place of the plan.
void Override(const StudyCommand& command, StudyPlan& plan) {
  plan.SetRuns(command.runs);
  plan.seed = command.seed;
  if (command.linear && !TakesEitherPlant(*plan.ask)) {
    throw InputError("--linear", command.preset + " has its own plant", "none");
  }
  plan.linear = plan.linear || command.linear;
  if (auto* const ask = std::get_if<AskEndurance>(&*plan.ask)) {
    if (command.duration > 0.0) ask->duration = command.duration;
    ask->every = command.every;
    for (const std::string& text : command.wear) ask->wear.push_back(ParseWear(text));
  } else if (command.duration > 0.0 || !command.wear.empty()) {
    throw InputError("--duration, --wear", command.preset + " is no long run",
                     "--preset endurance");
  }
}

/// A plan has all of that in it.
void CheckAlone(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string& name = option->get_name();
    const bool goes_with_a_plan = name == "--plan" || name == "--resume" ||
                                  name == "--restart" || name == "--out" ||
                                  name == "--threads" || name == "--patience" ||
                                  name == "--json" || name == "--report";
    if (option->count() == 0 || goes_with_a_plan) continue;
    throw InputError(name, "given beside --plan", "a key of the plan");
  }
}

void RunStudy(const CLI::App& app, const StudyCommand& command) {
  if (!command.plan.file.empty()) {
    CheckAlone(app);
    RunPlanFile(command.plan, command.output);
    return;
  }
  if (command.preset.empty()) {
    throw InputError("study", "neither --plan nor --preset", "one of them");
  }
  if (command.machine.setup.empty()) {
    throw InputError("--setup", "is missing", "a folder with setup.toml and the plant");
  }
  LoadedPlan loaded = ReadPreset(command.preset, LoadSubject(command.machine).nominal);
  Override(command, loaded.plan);
  AnswerPlan(loaded, {"preset", command.preset, command.runs, command.linear},
             command.output);
}

}  // namespace

void AddStudy(CLI::App& app) {
  auto options = std::make_shared<StudyCommand>();
  CLI::App* command = app.add_subcommand("study", "Run a study with its tables");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  command->get_option("--setup")->required(false);
  command->add_option(
      "--plan", options->plan.file,
      "A study of one's own: a file that says which machine, what varies "
      "and what is kept (docs/datasets.md)");
  command->add_flag("--restart", options->plan.restart,
                    "Forget the runs of the plan that are in the folder");
  command
      ->add_flag("--resume", options->plan.resume,
                 "Go on with them, as it does without --restart")
      ->excludes("--restart");
  command
      ->add_option("--threads", options->plan.threads,
                   "Threads that make the runs of a plan, of every rank under mpirun "
                   "(docs/cluster.md); default: the cores that the process may use")
      ->check(CLI::Range(1, kMostThreads))
      ->needs("--plan");
  command
      ->add_option("--patience", options->plan.patience,
                   "Under mpirun: how long a rank may be silent before others make its "
                   "runs [s]")
      ->check(Within(kLeastPatience, kLongestEndurance))
      ->needs("--plan");
  command->add_option("--preset", options->preset, "Which study")
      ->check(CLI::IsMember(PresetNames()));
  command->add_option("--runs", options->runs, "Monte-Carlo runs")
      ->check(CLI::Range(2, 1000000));
  AddSeedOption(*command, options->seed, "Seed of the first run");
  command->add_flag("--linear", options->linear,
                    "The linear plant, where a study has either");
  command->add_option("--duration", options->duration, "Of a long run, simulated [s]")
      ->check(Within(0.0, kLongestEndurance));
  command->add_option("--every", options->every, "A row of it, simulated [s]")
      ->check(Within(0.1, kLongestEndurance));
  command->add_option("--wear", options->wear,
                      "A fault parameter that grows by that an hour in its course, for "
                      "example zeta_x=0.01");
  command->callback([options, command] { RunStudy(*command, *options); });
}

}  // namespace mjdiag::app
