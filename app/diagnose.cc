// mjdiag diagnose: what has worn, from a measured or simulated record.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/output.h"
#include "mjdiag/diagnosis/diagnosis_fields.h"
#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/report/field_reference.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

struct DiagnoseOptions {
  MachineOptions machine;
  OutputOptions output;
  DiagnosisSource source;
  std::string record;
};

void Diagnose(const DiagnoseOptions& options) {
  const Machine machine = LoadSubject(options.machine).nominal;
  std::vector<std::string> notes;
  const Record record = ReadMeasured(machine.setup(), options.record, notes);
  const Excitation motion =
      NeedsMotion(options.source) ? Replay(machine.setup(), record) : Excitation{};
  PrepareOutput(options.output);
  const PreparedDiagnosis prepared = Prepare(machine, options.source, motion);
  const Diagnosis diagnosis = mjdiag::Diagnose(machine, prepared, record);
  auto document = nlohmann::json::parse(DiagnosisJson(diagnosis.result));
  document["command"] = CommandLine();
  document["record"] = std::filesystem::path(options.record).filename().string();
  std::string text = DiagnosisText(diagnosis.result);
  AddNotes(notes, document, text);
  Publish(options.output, "diagnosis", document, text, [&] {
    NamedPage page = PageOf(prepared.design, diagnosis, document["record"]);
    AddNotes(notes, page.page);
    return page;
  });
}

}  // namespace

void AddDiagnose(CLI::App& app) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command =
      app.add_subcommand("diagnose", "Find faults in a measured or simulated record");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  AddFieldsOption(*command, &FieldReference<DiagnosisResult>);
  AddDiagnosisOptions(*command, options->source);
  command->add_option("--record", options->record, "Record to be diagnosed")
      ->required();
  command->add_flag("--linear", options->source.nominal.linear,
                    "Thresholds from runs of the linearised plant");
  command->callback([options] { Diagnose(*options); });
}

}  // namespace mjdiag::app
