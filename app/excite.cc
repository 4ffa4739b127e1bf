// mjdiag excite: a motion within the limits of the axes that tells most.

#include <cmath>
#include <memory>

#include "app/command.h"
#include "app/excite_command.h"
#include "app/exit_status.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/plugin/extension/setup_folder.h"
#include "mjdiag/plugin/runtime/work_time.h"
#include "mjdiag/report/excitation_json.h"
#include "mjdiag/report/excitation_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/studies/excitation/motion_design.h"

namespace mjdiag::app {
namespace {

/// "x:velocity=0.3,force=100"
void ReadLimits(std::string_view text, std::map<std::string, AxisLimits>& limits) {
  const auto fail = [&](const std::string& what) {
    throw InputError(
        "--limit " + std::string(text), what,
        "<axis>:<name>=<number>,... of lowest, highest, velocity, acceleration, "
        "jerk, snap and force");
  };
  const std::size_t colon = text.find(':');
  if (colon == text.npos || colon == 0) fail("no axis");
  AxisLimits& own = limits[std::string(text.substr(0, colon))];
  const auto given = ParseAssignments(text.substr(colon + 1), fail);
  if (given.empty()) fail("no limit");
  for (const auto& [name, number] : given) {
    double* limit = FindLimit(own, name);
    if (limit == nullptr) fail("there is no '" + name + "'");
    if (!std::isfinite(number)) fail("'" + name + "' is not finite");
    *limit = number;
  }
}

std::string ExcitationText(const MotionDesign& design) {
  Table table({"unknown", "sd, default motion", "this motion", "times smaller", ""});
  for (std::size_t i = 0; i < design.unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    table.Add({design.unknowns[i], Short(design.before[at]), Short(design.after[at]),
               Short(design.before[at] / design.after[at]),
               design.wanted[i] ? "wanted" : ""});
  }
  std::string text = GainText(design) + "\n\n" + table.ToString() + "\n";
  if (!design.moves_of.empty()) {
    text += "moves of trajectory " + design.moves_of + ", " +
            Short(design.share_of_moves) + " times as far\n";
  }
  for (const ReferenceTone& tone : design.trajectory.tones) {
    text += "tone on " + tone.axis + ": " + Short(tone.frequency) + " Hz, amplitude " +
            Short(tone.amplitude) + "\n";
  }
  if (design.stopped) text += kStoppedText;
  return text;
}

void ExciteAxes(const Machine& machine, ExciteCommand& command) {
  if (!command.record.empty()) {
    throw InputError(
        "--record " + command.record, "the setup has controllers",
        "no --record: their default motion is what others are held against");
  }
  PrepareOutput(command.output);
  const Interrupt interrupt;
  MotionDesign design;
  {
    ProgressBar bar("motions");
    command.design.progress = [&bar](double fraction, double gain) {
      bar.ShowAndSay(fraction, gain > 1.0
                                   ? "sd " + FormatNumber(gain, 3) + " times smaller"
                                   : "the default motion");
    };
    command.design.stop = StopOf(command.budget);
    design = DesignMotion(machine, command.design);
  }
  std::string text = ExcitationText(design);
  if (!command.output.folder.empty()) {
    HoldFiles();
    WriteSetupFollowing(command.output.folder, command.machine.setup,
                        design.trajectory);
    text += "setup: " + command.output.folder + "/setup.toml\n";
  }
  nlohmann::json document = ToJson(machine, design);
  document["command"] = CommandLine();
  Publish(command.output, "excitation", document, text, [&] {
    return NamedPage{"excitation",
                     ExcitationPage(machine, design,
                                    {CommandLine(), "", {{"mjdiag", MJDIAG_VERSION}}})};
  });
  Interrupt::ThrowIfWished();
}

void Excite(ExciteCommand& command) {
  RequireUnchanged(command.machine, "the setup that is written");
  for (const std::string& text : command.limits)
    ReadLimits(text, command.design.limits);
  const Machine machine = LoadSubject(command.machine).nominal;
  if (machine.setup().control.axes.empty()) {
    ExciteJoints(machine, command);
  } else {
    ExciteAxes(machine, command);
  }
}

}  // namespace

std::function<bool()> StopOf(std::optional<double> budget) {
  return [is_over = AfterWork(budget)] { return Interrupt::IsWished() || is_over(); };
}

void AddExcite(CLI::App& app) {
  auto options = std::make_shared<ExciteCommand>();
  CLI::App* command = app.add_subcommand(
      "excite", "Design a motion within the limits of the axes that tells most");
  AddMachineOptions(*command, options->machine);
  AddOutputOptions(*command, options->output, false);
  AddReportOption(*command, options->output);
  command->add_option("--for", options->design.wanted,
                      "Fault parameter, or number of the plant (mass@x_stage), that is "
                      "wanted; may be given more than once; all fault parameters "
                      "without it");
  command->add_option(
      "--record", options->record,
      "Measured record: CSV, JSON, HDF5 or MAT, of a machine without controllers, "
      "which others are held against");
  command->add_option(
      "--limit", options->limits,
      "Limits of an axis or joint in the place of what that motion does: "
      "x:velocity=0.3,force=100; also lowest, highest (positions), "
      "acceleration, jerk, snap; may be given more than once");
  command
      ->add_option(
          "--max-frequency", options->design.highest_frequency,
          "Highest frequency of a tone [Hz]; 0: a quarter of the control rate, "
          "or what suits the limits of the joints")
      ->check(Within(0.0, 1e6));
  command->add_option("--name", options->design.name,
                      "Name of the trajectory, or of its file");
  command
      ->add_option(
          "--budget", options->budget,
          "Seconds of work after which no further motion is tried; all are without it")
      ->check(Within(1e-3, 1e6));
  command->callback([options] { Excite(*options); });
}

}  // namespace mjdiag::app
