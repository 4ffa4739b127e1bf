// mjdiag design: residual filters, prefilters and thresholds of a machine.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/output.h"
#include "mjdiag/plugin/design/design_facts.h"
#include "mjdiag/report/design_json.h"
#include "mjdiag/report/design_page.h"

namespace mjdiag::app {
namespace {

struct DesignOptions {
  MachineOptions machine;
  OutputOptions output;
  DiagnosisSource source;
  std::string method = "svd";
};

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
  const PreparedDiagnosis prepared = Prepare(
      machine, options.source,
      NeedsMotion(options.source) ? DefaultMotion(machine.setup()) : Excitation{});
  const DesignFacts facts = FactsOf(machine, options.method == "lp");
  nlohmann::json document = DesignJson(prepared.design, facts);
  document["command"] = CommandLine();
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
