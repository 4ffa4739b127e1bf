// mjdiag discover: the cause of what the simulation gets wrong, the extended plant and
// what it gains.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>

#include "app/command.h"
#include "app/discovery_output.h"
#include "app/exit_status.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "app/measured_records.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/report/discovery_fields.h"
#include "mjdiag/report/discovery_json.h"
#include "mjdiag/report/discovery_page.h"
#include "mjdiag/report/field_reference.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

constexpr double kLeastShare = 0.1;
constexpr double kMostShare = 0.95;
constexpr int kMostCauses = 20;
constexpr double kUsualBudget = 60.0;  // [s]
constexpr double kLeastBudget = 1e-3;
constexpr double kMostBudget = 1e9;

struct DiscoverCommand {
  MachineOptions machine;
  OutputOptions output;
  MeasurementOptions records;
  std::optional<bool> doubt;
  DiscoverOptions search;
};

// What was found is written over the plant as its file has it, so that changes to it
// can only come from that file.
void RequirePlantOfItsFile(const MachineOptions& options) {
  if (options.faults.empty() && options.effects.empty()) return;
  throw InputError("--fault, --effect", "the plant is not as its file has it",
                   "what is known beforehand in the MJCF file itself");
}

/// " (at most 190 s in all)".
std::string AtMost(double seconds) {
  if (!(seconds > 0.0) || !std::isfinite(seconds)) return "";
  return " (at most " + Short(std::ceil(seconds)) + " s in all)";
}

Discovery RunDiscovery(const Machine& machine, const DiscoverCommand& command,
                       const Measurements& measurements) {
  ProgressBar bar("discovering");
  DiscoverOptions options = command.search;
  options.doubt = command.doubt.value_or(!IsExact(machine.plant()));
  options.stop = [] { return Interrupt::IsWished(); };
  options.progress = [&bar](const DiscoveryProgress& progress) {
    bar.Show(progress.what, progress.fraction);
    bar.Say(progress.what + AtMost(progress.most_seconds), progress.best);
  };
  return Discover(machine, measurements, options);
}

// A plant that cannot be written must not cost the answer, which took its time.
std::string Extend(const DiscoverCommand& command, const Machine& machine,
                   Discovery& discovery) {
  try {
    return WriteExtendedPlant(command.output.folder, command.machine.setup, machine,
                              discovery);
  } catch (const InputError& error) {
    discovery.notes.push_back(std::string("The extended plant was not written. ") +
                              error.what());
    return "";
  }
}

void Discover(DiscoverCommand& command) {
  RequirePlantOfItsFile(command.machine);
  const std::string first = FirstRecord(command.records);
  std::vector<std::string> drafted = DraftMachine(command.machine, first);
  std::ranges::copy(AdoptClock(command.machine, first), std::back_inserter(drafted));
  const Machine machine = LoadSubject(command.machine).nominal;
  const Measurements measurements =
      LoadMeasurements(command.records, command.machine, machine);
  PrepareOutput(command.output);
  const Interrupt interrupt;
  Discovery discovery = RunDiscovery(machine, command, measurements);
  std::ranges::copy(drafted, std::back_inserter(discovery.notes));
  std::ranges::copy(NotesOn(machine), std::back_inserter(discovery.notes));

  HoldFiles();
  const std::string record = Names(measurements.fit);
  const std::string validation = Names(measurements.unseen);
  const DiscoveryRun run{{CommandLine(), record, {{"mjdiag", MJDIAG_VERSION}}},
                         validation,
                         Extend(command, machine, discovery)};
  nlohmann::json document = ToJson(discovery, run.extended_plant);
  document["record"] = record;
  document["validation"] =
      validation.empty() ? nlohmann::json() : nlohmann::json(validation);
  document["seed"] = command.search.seed;
  document["command"] = CommandLine();
  std::string text = DiscoveryAsText(discovery);
  if (!run.extended_plant.empty()) {
    text += "\nextended plant: " + run.extended_plant + "\n";
  }
  Publish(command.output, "discovery", document, text, [&] {
    return NamedPage{"discovery", DiscoveryPage(discovery, run)};
  });
  if (run.extended_plant.empty()) {
    RemoveExtendedPlant(command.output.folder, command.machine.setup);
  }
  Interrupt::ThrowIfWished();
  if (discovery.verdict == DiscoveryVerdict::kUnexplained) throw NegativeAnswer{};
}

}  // namespace

void AddDiscover(CLI::App& app) {
  auto options = std::make_shared<DiscoverCommand>();
  CLI::App* command = app.add_subcommand(
      "discover", "Find what the plant lacks on a measured record, and put it in");
  AddMachineOrPlantOptions(*command, options->machine);
  AddMeasurementOptions(*command, options->records);
  command
      ->add_option("--train-share", options->search.train_share,
                   "Share of the record, from its start, that fits see")
      ->check(Within(kLeastShare, kMostShare));
  command
      ->add_option(
          "--causes", options->search.most_causes,
          "Most causes to look for; 8 for every degree of freedom if not given")
      ->check(CLI::Range(1, kMostCauses));
  // Bound to the variable itself, a flag that is not given would count as 0: no doubt.
  command->add_flag_function(
      "--doubt,--estimate-parameters,!--no-doubt",
      [options](std::int64_t count) { options->doubt = count > 0; },
      "Numbers of the plant may be what is wrong, as far as they are not known "
      "beforehand, or they are true; without either they may where the plant does not "
      "say that it is exact");
  command->add_option("--known", options->search.known,
                      "What is as the plant says, a kind of numbers such as mass, or "
                      "one such as mass@stage; may be repeated");
  command
      ->add_option("--without", options->search.choice.without,
                   "No such causes: a family (friction, drive, structure, encoder), an "
                   "effect such as encoder_scale, one at a site such as "
                   "coulomb_friction@load, or a fault parameter; may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("--only", options->search.choice.only,
                   "No causes but those, named in the same way; may be repeated")
      ->allow_extra_args(false);
  options->search.budget = kUsualBudget;
  command
      ->add_option(
          "--budget", options->search.budget,
          "Seconds of work, 60 if not given, after which the best answer so far "
          "is given, if it has not settled before")
      ->check(Within(kLeastBudget, kMostBudget));
  AddSeedOption(*command, options->search.seed, "Seed of the noise floor");
  AddOutputOptions(*command, options->output, true);
  AddReportOption(*command, options->output);
  AddFieldsOption(*command, &FieldReference<Discovery>);
  command->callback([options] { Discover(*options); });
}

}  // namespace mjdiag::app
