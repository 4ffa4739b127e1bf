// mjdiag report: the HTML page of a run folder.

#include "mjdiag/report/report.h"

#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/output.h"

namespace mjdiag::app {
namespace {

struct ReportCommand {
  std::string folder;
  bool json = false;
};

void MakeReport(const ReportCommand& command) {
  const std::filesystem::path file = WriteReport(command.folder);
  const nlohmann::json document{{"schema", "mjdiag.report/1"},
                                {"report", file.string()},
                                {"bytes", std::filesystem::file_size(file)},
                                {"command", CommandLine()}};
  OutputOptions output;
  output.json = command.json;
  Publish(output, "report", document, "report: " + file.string() + "\n");
}

}  // namespace

void AddReport(CLI::App& app) {
  auto options = std::make_shared<ReportCommand>();
  CLI::App* command = app.add_subcommand(
      "report",
      "Make report.html of a run folder: every page and the clip that commands wrote "
      "into it with --out");
  command->add_option("folder", options->folder, "The folder")->required();
  command->add_flag("--json", options->json,
                    "Print one JSON document on stdout and nothing else");
  command->callback([options] { MakeReport(*options); });
}

}  // namespace mjdiag::app
