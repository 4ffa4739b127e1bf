// mjdiag calibrate: how well a machine is known, from measured healthy runs.

#include "mjdiag/plugin/design/calibrate.h"

#include <cmath>
#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/format.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/plant/fixed_numbers.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

namespace fs = std::filesystem;

struct CalibrateCommand {
  MachineOptions machine;
  OutputOptions output;
  std::vector<std::string> records;
  CalibrateOptions calibration;
  NominalRuns runs;
};

void RequireOtherFolder(const fs::path& setup_file, const fs::path& folder) {
  if (fs::exists(folder) && fs::equivalent(setup_file.parent_path(), folder)) {
    throw InputError("--out", "is the folder of the setup itself", "another folder");
  }
}

std::string CalibrationText(const CalibrateCommand& command,
                            const CalibrationReport& report) {
  const Calibration& calibration = report.calibration;
  Table numbers({"number", "times", "sd [%]", "was known to [%]"});
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    numbers.Add({calibration.numbers[i], Short(calibration.factors[at]),
                 Short(100.0 * calibration.Sd()[at]),
                 Short(100.0 * report.prior_sd[at])});
  }
  std::string text = numbers.ToString() + "\nforce noise: ";
  text += calibration.force_noise > 0.0 ? "the twin is pulled along with " +
                                              Short(calibration.force_noise) + " Hz"
                                        : std::string("none");
  text += "\nsensor noise:";
  for (const double noise : calibration.sensor_noise) text += " " + Short(noise);
  text += "\n";
  for (std::size_t i = 0; i < report.records.size(); ++i) {
    const CalibratedRecord& record = report.records[i];
    text += command.records[i] + ": NIS " + Short(record.nis) +
            (record.nis > 2.0 ? ", which this plant does not explain" : "") + "\n";
  }
  if (calibration.model.any()) {
    text +=
        "What this plant lacks makes faults uncertain, in standard deviations of what "
        "all records say together:";
    const Eigen::VectorXd sd = calibration.model.covariance.diagonal().cwiseSqrt();
    for (std::size_t i = 0; i < calibration.model.unknowns.size(); ++i) {
      text += (i == 0 ? " " : ", ") + calibration.model.unknowns[i] + " " +
              Short(100.0 * sd[static_cast<Eigen::Index>(i)]) + " %";
    }
    text += "\n";
  }
  if (!report.doubts.empty()) {
    text += "Far from what was known, as on a machine that was not healthy:";
    for (const std::string& name : report.doubts) text += " " + name;
    text += "\n";
  }
  return text;
}

nlohmann::json CalibrationDocument(const CalibrateCommand& command,
                                   const CalibrationReport& report) {
  const Calibration& calibration = report.calibration;
  nlohmann::json document = {
      {"schema", "mjdiag.calibration_report/1"},
      {"command", CommandLine()},
      {"force_noise", calibration.force_noise},
      {"numbers", nlohmann::json::array()},
      {"records", nlohmann::json::array()},
      {"doubts", report.doubts},
      {"tolerated", calibration.tolerated},
      {"model_uncertainty", nlohmann::json::array()},
  };
  if (calibration.model.any()) {
    const Eigen::VectorXd sd = calibration.model.covariance.diagonal().cwiseSqrt();
    for (std::size_t i = 0; i < calibration.model.unknowns.size(); ++i) {
      document["model_uncertainty"].push_back(
          {{"name", calibration.model.unknowns[i]},
           {"sd", sd[static_cast<Eigen::Index>(i)]}});
    }
  }
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    document["numbers"].push_back({{"name", calibration.numbers[i]},
                                   {"factor", calibration.factors[at]},
                                   {"sd", calibration.Sd()[at]},
                                   {"prior_sd", report.prior_sd[at]}});
  }
  for (std::size_t i = 0; i < report.records.size(); ++i) {
    document["records"].push_back(
        {{"file", fs::path(command.records[i]).filename().string()},
         {"misfit", report.records[i].nis}});
  }
  return document;
}

void RunCalibration(CalibrateCommand& command) {
  RequireUnchanged(command.machine, "the calibrated setup");
  const fs::path setup_file = fs::absolute(FindSetupFile(command.machine.setup));
  const fs::path folder = command.output.folder;
  Setup setup = ReadSetup(command.machine.setup);
  RequireOtherFolder(setup_file, folder);
  setup.calibration.reset();
  const Machine machine(setup);
  std::vector<Record> records;
  std::vector<std::string> notes;
  for (const std::string& file : command.records) {
    records.push_back(ReadMeasured(setup, file, notes));
  }
  PrepareOutput(command.output);
  CalibrationReport report;
  DiagnosisDesign design;
  {
    ProgressBar bar("calibrating");
    command.calibration.linear = command.runs.linear;
    command.calibration.progress = bar.Shower();
    report = Calibrate(machine, records, command.calibration);
  }
  setup.calibration = report.calibration;
  const Machine calibrated(setup);
  {
    ProgressBar bar("healthy runs");
    command.runs.progress = bar.Shower();
    design = CalibratedFilters(calibrated, records, command.runs);
  }
  HoldFiles();
  WriteCalibratedSetup(folder, setup_file, report.calibration, design);
  nlohmann::json document = CalibrationDocument(command, report);
  std::string text = CalibrationText(command, report);
  if (const std::string fixed = NoteOfFixedNumbers(machine.plant()); !fixed.empty()) {
    notes.push_back(fixed);
  }
  AddNotes(notes, document, text);
  Publish(command.output, "calibration_report", document, text);
}

}  // namespace

void AddCalibrate(CLI::App& app) {
  auto options = std::make_shared<CalibrateCommand>();
  CLI::App* command = app.add_subcommand(
      "calibrate", "Learn from measured healthy runs how well a machine is known");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, true);
  command
      ->add_option("--record", options->records,
                   "Record of a healthy run; may be given more than once")
      ->required();
  command->add_flag("--linear", options->runs.linear, "Take the plant as linear");
  command->callback([options] { RunCalibration(*options); });
}

}  // namespace mjdiag::app
