// mjdiag design: residual filters, prefilters and thresholds of a machine.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/output.h"
#include "app/parity_programs.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/report/design_page.h"

namespace mjdiag::app {
namespace {

struct DesignOptions {
  MachineOptions machine;
  OutputOptions output;
  DiagnosisSource source;
  std::string method = "svd";
};

// Beyond it a plant without parity relations is one without redundancy.
constexpr int kHighestDegree = 40;

// What is left of a spring in the plot of what lost stiffness changes ([AB383],
// Fig. 30).
constexpr double kLostStiffness = 0.01;

std::vector<ChangedMachine> WithoutStiffness(const Machine& machine) {
  std::vector<ChangedMachine> changed;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    if (parameter.kind != PlantNumberKind::kStiffness) continue;
    changed.push_back(
        {parameter.name + " = " + Short(kLostStiffness),
         machine.With({{{parameter.name, kLostStiffness}}, {}}).linear()});
  }
  return changed;
}

DesignFacts FactsOf(const Machine& machine, bool linear_programs) {
  DesignFacts facts;
  facts.healthy = machine.linear();
  const SynthesisOptions options = SynthesisOf(machine);
  const StateSpace system = DeltaForm(facts.healthy, options.timing);
  facts.observability_ranks = ObservabilityRanks(system, options.residual.degree);
  facts.states = system.states();
  facts.minimal_degree =
      MinimalDegree(system, UnknownForces(facts.healthy, options), kHighestDegree);
  if (linear_programs)
    facts.linear_program = SolveParityPrograms(machine, facts.healthy);
  return facts;
}

nlohmann::json ToJson(const ParityProgramFacts& facts) {
  const bool found = facts.feasible > 0;
  return {{"degree", facts.degree},
          {"norm", facts.norm},
          {"fault_inputs", facts.fault_inputs},
          {"programs", facts.programs},
          {"feasible", facts.feasible},
          {"objective", found ? nlohmann::json(facts.objective) : nlohmann::json()},
          {"defect", found ? nlohmann::json(facts.defect) : nlohmann::json()},
          {"angle", found ? nlohmann::json(facts.angle) : nlohmann::json()}};
}

std::string Summary(const DiagnosisDesign& design, const DesignFacts& facts) {
  const ThresholdDesign& residual = design.limits.residual;
  std::string text = design.setup + ": parity relations exist from degree " +
                     std::to_string(facts.minimal_degree) + " on; " +
                     std::to_string(design.bank.residuals) + " of degree " +
                     std::to_string(design.options.residual.degree) +
                     " over a Butterworth low-pass of order " +
                     std::to_string(design.options.residual.denominator.order) +
                     " at " + Short(design.options.residual.denominator.cutoff) +
                     " Hz\n\n";
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
  text += "\n";
  if (facts.linear_program)
    text += DescribeParityPrograms(*facts.linear_program) + "\n";
  return text;
}

/// The page of a design.
NamedPage PageOfDesign(const Machine& machine, const DiagnosisDesign& design,
                       DesignFacts facts) {
  facts.changed = WithoutStiffness(machine);
  const RunDescription run{CommandLine(), "", {{"mjdiag", MJDIAG_VERSION}}};
  return {"design", DesignPage(design, facts, run)};
}

void Design(const DesignOptions& options) {
  const Machine machine = LoadSubject(options.machine).nominal;
  PrepareOutput(options.output);
  std::vector<std::string> notes;  // of records, and there is none
  const PreparedDiagnosis prepared =
      Prepare(machine, options.source, MakeExcitation(machine.setup(), {}, notes));
  const DesignFacts facts = FactsOf(machine, options.method == "lp");
  auto document = nlohmann::json::parse(FiltersJson(prepared.design));
  document["command"] = CommandLine();
  document["observability_ranks"] = facts.observability_ranks;
  document["states"] = facts.states;
  document["minimal_degree"] = facts.minimal_degree;
  if (facts.linear_program) document["linear_program"] = ToJson(*facts.linear_program);
  std::string text = Summary(prepared.design, facts);
  if (!options.output.folder.empty()) {
    text += "filters: " +
            (std::filesystem::path(options.output.folder) / "filters.json").string() +
            "\n";
  }
  Publish(options.output, "filters", document, text,
          [&] { return PageOfDesign(machine, prepared.design, facts); });
}

}  // namespace

void AddDesign(CLI::App& app) {
  auto options = std::make_shared<DesignOptions>();
  CLI::App* command =
      app.add_subcommand("design", "Make residual filters, prefilters and thresholds");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  AddDiagnosisOptions(*command, options->source);
  command->add_flag("--linear", options->source.nominal.linear,
                    "Thresholds from runs of the linearised plant");
  command
      ->add_option(
          "--method", options->method,
          "lp: also solve the linear programs for a parity relation and "
          "report them; the filters come from the singular value decomposition in "
          "both cases")
      ->check(CLI::IsMember({"svd", "lp"}));
  command->callback([options] { Design(*options); });
}

}  // namespace mjdiag::app
