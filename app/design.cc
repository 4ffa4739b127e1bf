// mjdiag design: residual filters, prefilters and thresholds of a machine.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/output.h"
#include "mjdiag/diagnosis/delta_form.h"
#include "mjdiag/diagnosis/left_null_space.h"
#include "mjdiag/plugin/filter_design.h"
#include "mjdiag/plugin/linearize.h"
#include "mjdiag/report/filters_file.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::app {
namespace {

struct DesignOptions {
  MachineOptions machine;
  OutputOptions output;
  DiagnosisSource source;
  bool linear = false;
};

// Beyond it a plant without rows is one without redundancy.
constexpr int kHighestDegree = 40;

nlohmann::json RankJson(const Machine& machine) {
  const MechanicalModel model = Linearize(*machine.plant, machine.setup);
  const SynthesisOptions options = SynthesisOf(machine.setup, model);
  const StateSpace system = DeltaForm(model, options.timing);
  return {{"observability_ranks", ObservabilityRanks(system, options.degree)},
          {"states", system.states()},
          {"minimal_degree", MinimalDegree(system, NoSignal(system), kHighestDegree)}};
}

std::string Summary(const DiagnosisDesign& design, const nlohmann::json& ranks) {
  const ThresholdDesign& residual = design.limits.residual;
  std::string text = design.setup + ": residual rows exist from degree " +
                     std::to_string(ranks["minimal_degree"].get<int>()) + " on; " +
                     std::to_string(design.bank.residuals) + " of degree " +
                     std::to_string(design.options.degree) +
                     " over a Butterworth low-pass of order " +
                     std::to_string(design.options.denominator.order) + " at " +
                     Short(design.options.denominator.cutoff) + " Hz\n\n";
  Table table({"limit", "from", "to"});
  table.Add({"residual", Short(residual.limits.min), Short(residual.limits.max)});
  table.Add({"mean of |r|", "0", Short(design.limits.integral)});
  table.Add({"disturbance peak", "0", Short(design.limits.disturbance.peak)});
  table.Add({"disturbance power", "0", Short(design.limits.disturbance.total)});
  text += table.ToString();
  text += "\nThe residual is in units of its own noise; margin " +
          Short(residual.alpha) + ", normal fit " + Short(residual.fit.mean) + " +- " +
          Short(residual.fit.sd) + ". Faults estimated:";
  for (const std::string& name : design.FaultNames()) text += " " + name;
  return text + "\n";
}

void Design(const DesignOptions& options) {
  const Machine machine = LoadMachine(options.machine);
  PrepareOutput(options.output);
  const nlohmann::json ranks = RankJson(machine);
  const Excitation excitation = MakeExcitation(machine.setup, {});
  const ReadyDiagnosis ready =
      PrepareDiagnosis(options.source, machine, excitation, options.linear);
  nlohmann::json document = ToJson(ready.design);
  document["command"] = CommandLine();
  document.update(ranks);
  std::string text = Summary(ready.design, ranks);
  if (!options.output.folder.empty()) {
    text += "filters: " +
            (std::filesystem::path(options.output.folder) / "filters.json").string() +
            "\n";
  }
  Publish(options.output, "filters", document, text);
}

}  // namespace

void AddDesign(CLI::App& app) {
  auto options = std::make_shared<DesignOptions>();
  CLI::App* command =
      app.add_subcommand("design", "Make residual filters, prefilters and thresholds");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddDiagnosisOptions(*command, options->source);
  command->add_flag("--linear", options->linear,
                    "Thresholds from runs of the linearised plant");
  command->callback([options] { Design(*options); });
}

}  // namespace mjdiag::app
