// mjdiag init: a setup from a plant and a log.

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/exit_status.h"
#include "app/format.h"
#include "app/output.h"
#include "mjdiag/plugin/draft/setup_draft.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/scratch_folder.h"

namespace mjdiag::app {
namespace {

namespace fs = std::filesystem;

struct InitCommand {
  std::string plant;
  std::string record;
  OutputOptions output;
  bool force = false;
};

void RequireNoSetup(const InitCommand& command) {
  if (command.force) return;
  const fs::path folder = command.output.folder;
  for (const char* name : {"setup.toml", "plant.xml"}) {
    if (!fs::exists(folder / name)) continue;
    throw InputError((folder / name).string(), "is there already",
                     "another folder, or --force to replace it");
  }
}

/// Even with --force: the model of the user is not what is drafted.
void RequireOtherPlant(const InitCommand& command) {
  const fs::path written = fs::path(command.output.folder) / "plant.xml";
  if (fs::exists(written) && fs::equivalent(written, command.plant)) {
    throw InputError("--out", "has the plant itself", "another folder");
  }
}

std::string ChannelTable(const SetupDraft& draft) {
  Table table({"column", "is", "element", "unit"});
  for (const auto& [kind, channels] :
       {std::pair{"sensor", &draft.sensors}, {"actuator", &draft.actuators}}) {
    for (const DraftedChannel& channel : *channels) {
      const std::string component =
          channel.component > 0 ? ":" + std::to_string(channel.component) : "";
      table.Add({channel.column.empty() ? channel.channel : channel.column, kind,
                 channel.element + component,
                 channel.column_unit.empty() ? channel.unit : channel.column_unit});
    }
  }
  return table.ToString();
}

std::string Section(const std::string& title, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "  " + line + "\n";
  return text.empty() ? text : "\n" + title + "\n" + text;
}

nlohmann::json ChannelsJson(const std::vector<DraftedChannel>& channels) {
  nlohmann::json list = nlohmann::json::array();
  for (const DraftedChannel& channel : channels) {
    list.push_back({{"channel", channel.channel},
                    {"element", channel.element},
                    {"component", channel.component},
                    {"unit", channel.unit},
                    {"column", channel.column},
                    {"column_unit", channel.column_unit}});
  }
  return list;
}

nlohmann::json DraftJson(const SetupDraft& draft) {
  return {{"schema", "mjdiag.init/1"},
          {"command", CommandLine()},
          {"name", draft.name},
          {"certain", draft.certain()},
          {"rates", {{"control", draft.control}, {"substeps", draft.substeps}}},
          {"sensors", ChannelsJson(draft.sensors)},
          {"actuators", ChannelsJson(draft.actuators)},
          {"assumed", draft.assumed},
          {"added", draft.added},
          {"questions", draft.questions},
          {"unused", draft.unused},
          {"notes", draft.notes}};
}

/// A draft that is certain is one that every command takes.
void RequireUsable(const SetupDraft& draft, const fs::path& folder) {
  if (!draft.certain()) return;
  const Machine machine(ReadSetup(folder));
  if (!draft.record.empty()) ReadMeasured(machine.setup(), draft.record);
}

void Init(const InitCommand& command) {
  RequireNoSetup(command);
  const SourcePlant source = LoadSourcePlant(command.plant);
  RequireOtherPlant(command);
  const SetupDraft draft = DraftSetup(source, command.plant, command.record);
  {
    const ScratchFolder scratch;
    WriteDraft(draft, source, scratch.path());
    RequireUsable(draft, scratch.path());
  }
  PrepareOutput(command.output);
  HoldFiles();
  WriteDraft(draft, source, command.output.folder);
  std::string text =
      draft.name + ", " + Short(draft.control) + " Hz, " +
      std::to_string(draft.substeps) + " steps a tick\n\n" + ChannelTable(draft) +
      Section("assumed:", draft.assumed) + Section("added to the plant:", draft.added) +
      Section("of the log, not used:", draft.unused) + Section("notes:", draft.notes) +
      Section("could not be told:", draft.questions) + "\n" +
      (fs::path(command.output.folder) / "setup.toml").string() + "\n";
  Publish(command.output, "init", DraftJson(draft), text);
  if (!draft.certain()) throw NegativeAnswer{};
}

}  // namespace

void AddInit(CLI::App& app) {
  auto options = std::make_shared<InitCommand>();
  CLI::App* command = app.add_subcommand(
      "init", "Draft a setup from a plant and a log, and say what could not be told");
  command->add_option("--plant", options->plant, "The plant: an MJCF or URDF file")
      ->required();
  command->add_option("--record", options->record,
                      "A log of the machine: CSV, JSON, HDF5 or MAT (default: none, a "
                      "setup with all joints and actuators)");
  command->add_flag("--force", options->force,
                    "Replace the setup.toml and plant.xml of the folder");
  AddOutputOptions(*command, options->output, true);
  command->footer(
      "Exit status: 0 the setup is certain, 1 it is written, with questions that the "
      "log does not answer, 2 bad input or usage.");
  command->callback([options] { Init(*options); });
}

}  // namespace mjdiag::app
