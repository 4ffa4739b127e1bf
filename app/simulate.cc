// mjdiag simulate: a run of the machine, as a record.

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/output.h"
#include "app/stream.h"
#include "app/subject.h"
#include "app/tolerance_output.h"
#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/design/tolerant_run.h"
#include "mjdiag/report/tolerance_json.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::app {
namespace {

struct SimulateOptions {
  MachineOptions machine;
  MotionOptions motion;
  OutputOptions output;
  std::string format = "csv";
  bool log_joints = false;
  bool diagnose = false;
  bool tolerate = false;
  DiagnosisSource source;
  StreamOptions stream;
};

/// Largest |reference - reading| of every axis.
std::map<std::string, double> LargestTrackingErrors(const Setup& setup,
                                                    const Record& record) {
  std::map<std::string, double> errors;
  for (const AxisSetup& axis : setup.control.axes) {
    const Channel* reference = record.Find(axis.name + "_ref");
    if (reference == nullptr) continue;
    errors[axis.name] =
        (reference->samples - record.At(axis.sensor).samples).lpNorm<Eigen::Infinity>();
  }
  return errors;
}

std::string RunSummary(const Setup& setup, const Subject& subject, const Record& record,
                       const nlohmann::json& document) {
  std::string text = setup.name + ", " + SubjectText(subject) + ": " +
                     std::to_string(record.samples()) + " samples, " +
                     Short(record.duration()) + " s, " +
                     Short(document["real_time_factor"]) + " times real time\n\n";
  Table table({"axis", "largest tracking error", "peak input"});
  for (const AxisSetup& axis : setup.control.axes) {
    const Channel& input = record.At(axis.actuator);
    table.Add({axis.name,
               FormatQuantity(document["tracking_error_max"][axis.name],
                              setup.channels.Sensor(axis.sensor).unit),
               FormatQuantity(input.samples.lpNorm<Eigen::Infinity>(), input.unit)});
  }
  return text + (setup.control.axes.empty() ? "" : table.ToString());
}

void Simulate(const SimulateOptions& options) {
  Subject subject = LoadSubject(options.machine);
  SetMotion(options.motion, subject.options);
  CheckMode(subject.setup().control, subject.options.mode);
  if (options.stream.wanted()) {
    return Stream(subject, options.motion, options.stream);
  }
  subject.options.log_joints = options.log_joints;
  std::vector<std::string> notes = NotesOn(subject.nominal);
  const Excitation excitation = MakeExcitation(subject.setup(), options.motion, notes);
  PrepareOutput(options.output);

  std::optional<PreparedDiagnosis> prepared;
  if (options.diagnose || options.tolerate) {
    DiagnosisSource source = options.source;
    source.nominal.linear = options.motion.linear;
    prepared = Prepare(subject.nominal, source, excitation);
  }
  std::chrono::duration<double> elapsed{};
  const auto run = [&](const RunOptions& with) {
    const auto start = std::chrono::steady_clock::now();
    Record made = Run(subject.machine, options.motion, excitation, with, "simulating");
    elapsed = std::chrono::steady_clock::now() - start;
    return made;
  };
  Record record;
  std::optional<Diagnosis> diagnosis;
  std::optional<TolerancePlan> plan;
  std::optional<TolerantRun> tolerant;
  if (options.tolerate) {
    plan = PlanTolerance(subject.nominal, subject.options.mode);
    tolerant = RunTolerantly(subject.nominal, *prepared, *plan, excitation.samples(),
                             subject.options, run);
    record = std::move(tolerant->record);
    diagnosis = std::move(tolerant->diagnosis);
  } else if (options.diagnose) {
    DiagnosisRecording recording =
        BeginDiagnosis(subject.nominal, *prepared, excitation.samples());
    MonitorObserver observer(recording);
    subject.options.observer = &observer;
    record = run(subject.options);
    recording.Finish();
    diagnosis = ConcludeWithLog(recording);
  } else {
    record = run(subject.options);
  }

  nlohmann::json document = ToJson(subject);
  document["schema"] = "mjdiag.simulate/1";
  document["setup"] = subject.setup().name;
  document["command"] = CommandLine();
  document["linear"] = options.motion.linear;
  document["seed"] = options.motion.seed;
  document["samples"] = record.samples();
  document["sample_time"] = record.sample_time();
  document["tracking_error_max"] = LargestTrackingErrors(subject.setup(), record);
  document["real_time_factor"] = record.duration() / elapsed.count();
  std::string text = RunSummary(subject.setup(), subject, record, document);
  if (!options.output.folder.empty()) {
    HoldFiles();
    const RecordFormat format = ParseRecordFormat(options.format);
    const auto file =
        std::filesystem::path(options.output.folder) / ("record" + Extension(format));
    WriteRecord(file, record, format);
    document["record"] = file.filename().string();
    text += "\nrecord: " + file.string() + "\n";
  }
  std::function<NamedPage()> page;
  if (tolerant) {
    document["tolerance"] = ToleranceJson(*tolerant, *plan, subject.setup());
    text += "\n" + DescribeTolerance(tolerant->faults);
  }
  if (diagnosis) {
    document["diagnosis"] = nlohmann::json::parse(DiagnosisJson(diagnosis->result));
    text += "\n" + DiagnosisText(diagnosis->result);
    if (!options.output.folder.empty()) {
      WriteTextFile(std::filesystem::path(options.output.folder) / "diagnosis.json",
                    document["diagnosis"].dump(2) + "\n");
    }
    page = [&] {
      return PageOf(prepared->design, *diagnosis, "simulated: " + SubjectText(subject));
    };
  }
  AddNotes(notes, document, text);
  Publish(options.output, "simulate", document, text, page);
}

}  // namespace

void AddSimulate(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command =
      app.add_subcommand("simulate", "Run the machine and write the record");
  AddMachineOptions(*command, options->machine);
  AddMotionOptions(*command, options->motion);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  command->add_option("--format", options->format, "Format of the record")
      ->check(CLI::IsMember({"csv", "mat", "mat73"}));
  command->add_flag("--log-joints", options->log_joints,
                    "Also record the position of every joint");
  command->add_flag("--diagnose", options->diagnose,
                    "Run the diagnosis inside the control callback");
  command->add_flag("--tolerate", options->tolerate,
                    "Let what it finds act on the controllers while the machine runs");
  AddDiagnosisOptions(*command, options->source);
  AddStreamOptions(*command, options->stream);
  command->callback([options] { Simulate(*options); });
}

}  // namespace mjdiag::app
