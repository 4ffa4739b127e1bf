// mjdiag excite, of a machine whose controllers are not known: beside a measured motion.

#include <filesystem>

#include "app/command.h"
#include "app/excite_command.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/report/excitation_json.h"
#include "mjdiag/report/joint_excitation_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/studies/excitation/joint_motion_design.h"

namespace mjdiag::app {
namespace {

std::string JointExcitationText(const JointMotionDesign& design) {
  Table table({"number", "sd, measured motion", "this motion", "times smaller"});
  for (std::size_t i = 0; i < design.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    table.Add({design.numbers[i], FormatQuantity(design.before[at], design.units[i]),
               FormatQuantity(design.after[at], design.units[i]),
               Short(design.before[at] / design.after[at])});
  }
  return ConditionText(design) + "\n\n" + table.ToString() + "\n" + ToldText(design) +
         "\n" + (design.stopped ? kStoppedText : "");
}

}  // namespace

void ExciteJoints(const Machine& machine, const ExciteCommand& command) {
  if (command.record.empty()) {
    throw InputError("--setup", "'" + machine.setup().name + "' has no controlled axes",
                     "--record RECORD with a motion of it");
  }
  if (!command.design.wanted.empty()) {
    throw InputError("--for " + command.design.wanted.front(),
                     "'" + machine.setup().name + "' has no controlled axes",
                     "no --for: all numbers of its links and joints are wanted");
  }
  std::vector<std::string> notes;
  const Record measured = ReadMeasured(machine.setup(), command.record, notes);
  PrepareOutput(command.output);
  const Interrupt interrupt;
  JointMotionDesign design;
  {
    ProgressBar bar("motions");
    design = DesignJointMotion(
        machine, ToMeasuredRun(machine.setup(), measured),
        {.limits = command.design.limits,
         .highest_frequency = command.design.highest_frequency,
         .progress =
             [&bar](double fraction, double condition) {
               bar.ShowAndSay(fraction,
                              "condition number " + FormatNumber(condition, 3));
             },
         .stop = StopOf(command.budget)});
  }
  nlohmann::json document = ToJson(machine, design);
  document["command"] = CommandLine();
  document["record"] = command.record;
  std::string text = JointExcitationText(design);
  if (!command.output.folder.empty()) {
    HoldFiles();
    const auto file =
        std::filesystem::path(command.output.folder) / (command.design.name + ".csv");
    WriteRecord(file, design.Motion(), RecordFormat::kCsv);
    text += "motion: " + file.string() + "\n";
  }
  AddNotes(notes, document, text);
  Publish(command.output, "excitation", document, text, [&] {
    NamedPage page{"excitation",
                   JointExcitationPage(
                       machine, design,
                       {CommandLine(), command.record, {{"mjdiag", MJDIAG_VERSION}}})};
    AddNotes(notes, page.page);
    return page;
  });
  Interrupt::ThrowIfWished();
}

}  // namespace mjdiag::app
