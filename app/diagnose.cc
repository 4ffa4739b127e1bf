// mjdiag diagnose: what has worn, from a measured or simulated record.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/output.h"
#include "mjdiag/diagnosis/refined_estimate.h"
#include "mjdiag/plugin/design/fault_models.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/report/diagnosis_json.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

struct DiagnoseOptions {
  MachineOptions machine;
  OutputOptions output;
  DiagnosisSource source;
  std::string record;
  bool linear = false;
  bool refine = false;
};

/// First sample of the horizon at the end of the record.
Eigen::Index HorizonStart(const DiagnosisDesign& design, const Record& record) {
  const double horizon = design.options.horizon;
  if (horizon == 0.0) return 0;
  if (horizon > record.duration() * (1.0 + 1e-9)) {
    throw InputError(
        "horizon", FormatQuantity(horizon, "s"),
        "no more than the record's " + FormatQuantity(record.duration(), "s"));
  }
  return record.samples() -
         static_cast<Eigen::Index>(horizon / record.sample_time() + 0.5);
}

DiagnosisResult Refined(const Machine& machine, const DiagnosisDesign& design,
                        const DiagnosisMonitor& monitor, const Record& record) {
  const MechanicalModel& healthy = machine.linear();
  const RefinedEstimate refined = RefineEstimate(
      design, SynthesisOf(machine.setup(), healthy),
      FaultModels(machine),
      Magnitudes(machine), record, HorizonStart(design, record));
  return Conclude(design, monitor, refined.estimate);
}

void Diagnose(const DiagnoseOptions& options) {
  if (options.refine && options.source.baseline) {
    throw InputError("--refine", "does not go with --baseline",
                     "one of the two: a baseline belongs to the healthy filters");
  }
  const Machine machine = LoadSubject(options.machine).nominal;
  const Record record = ReadRecord(options.record, machine.setup().record);
  const bool needs_motion = options.source.baseline || !options.source.robust.empty();
  const Excitation excitation =
      needs_motion ? Replay(machine.setup(), record) : Excitation{};
  PrepareOutput(options.output);
  const ReadyDiagnosis ready =
      PrepareDiagnosis(options.source, machine, excitation, options.linear);
  DiagnosisMonitor monitor(ready.design, record.samples(), ready.baseline);
  monitor.RegressFrom(HorizonStart(ready.design, record));
  Run(monitor, ready.design, record);
  const DiagnosisResult result = options.refine
                                     ? Refined(machine, ready.design, monitor, record)
                                     : Conclude(ready, machine, excitation, monitor);
  nlohmann::json document = ToJson(result);
  document["command"] = CommandLine();
  document["record"] = std::filesystem::path(options.record).filename().string();
  Publish(options.output, "diagnosis", document, Describe(result),
          [&] { return PageOf(ready.design, monitor, result, document["record"]); });
}

}  // namespace

void AddDiagnose(CLI::App& app) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command =
      app.add_subcommand("diagnose", "Find faults in a measured or simulated record");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  AddDiagnosisOptions(*command, options->source);
  command->add_option("--record", options->record, "Record to be diagnosed")
      ->required();
  command->add_flag("--linear", options->linear,
                    "Thresholds from runs of the linearised plant");
  command->add_flag("--refine", options->refine,
                    "Make the filters anew about the estimate until it settles: exact "
                    "for large faults where the linear model holds");
  command->callback([options] { Diagnose(*options); });
}

}  // namespace mjdiag::app
