#include "app/output.h"

#include <cstdio>
#include <optional>

#include "mjdiag/report/page/page_file.h"
#include "mjdiag/report/page/plot_library.h"
#include "mjdiag/report/report.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/folder_update.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::app {

void AddOutputOptions(CLI::App& command, OutputOptions& options, bool folder_required) {
  CLI::Option* out =
      command.add_option("--out", options.folder, "Folder for the files of this run");
  if (folder_required) out->required();
  command.add_flag("--json", options.json,
                   "Print one JSON document on stdout and nothing else");
}

void AddReportOption(CLI::App& command, OutputOptions& options) {
  command
      .add_flag("--report", options.report,
                "Make report.html of the folder: one page with all that commands and "
                "render wrote into it")
      ->needs("--out");
}

void AddFieldsOption(CLI::App& command, std::string (*reference)()) {
  command.add_flag_callback(
      "--fields",
      [reference] {
        std::fputs(reference().c_str(), stdout);
        throw CLI::Success();
      },
      "Print what the JSON document has, a line each: name, unit and what it is; "
      "nothing else is done");
}

namespace {

/// What PrepareOutput made, the outermost folder first.
std::vector<std::filesystem::path> made_folders;

std::optional<FolderUpdate> held_files;

}  // namespace

void PrepareOutput(const OutputOptions& options) {
  if (options.report) LoadPlotLibrary();
  if (options.folder.empty()) return;
  std::filesystem::path path;
  for (const std::filesystem::path& part : std::filesystem::path(options.folder)) {
    path /= part;
    if (!std::filesystem::exists(path)) made_folders.push_back(path);
  }
  MakeOutputFolder(options.folder);
}

void HoldFiles() { held_files.emplace(); }

void DiscardOutput() {
  held_files.reset();
  // Fails on a folder that has something in it, as it should.
  std::error_code ignored;
  for (; !made_folders.empty(); made_folders.pop_back()) {
    std::filesystem::remove(made_folders.back(), ignored);
  }
}

namespace {

/// The report of the folder, and what to say about it.
std::string MakeReport(const OutputOptions& options) {
  if (options.report) return "\nreport: " + WriteReport(options.folder).string() + "\n";
  return "\n`mjdiag report " + options.folder + "` makes a page of it\n";
}

}  // namespace

void Publish(const OutputOptions& options, const std::string& name,
             const nlohmann::json& document, const std::string& text,
             const std::function<NamedPage()>& page) {
  const std::string dump =
      document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::string made;
  if (!options.folder.empty()) {
    if (!held_files) HoldFiles();
    WriteTextFile(std::filesystem::path(options.folder) / (name + ".json"), dump);
    if (page) {
      const NamedPage named = page();
      WritePage(options.folder, named.name, named.page);
    }
    held_files->Commit();
    held_files.reset();
    if (page) made = MakeReport(options);
  }
  if (std::fputs(options.json ? dump.c_str() : (text + made).c_str(), stdout) < 0 ||
      std::fflush(stdout) != 0) {
    throw InputError("standard output", "cannot be written", "a place for the results");
  }
}

void AddNotes(const std::vector<std::string>& notes, nlohmann::json& document,
              std::string& text) {
  if (notes.empty()) return;
  document["notes"] = notes;
  for (const std::string& note : notes) text += "\nnote: " + note + "\n";
}

void AddNotes(const std::vector<std::string>& notes, Page& page) {
  if (notes.empty()) return;
  page.AddHeading("Notes");
  for (const std::string& note : notes) page.AddParagraph(note);
}

RecordFormat ParseRecordFormat(const std::string& name) {
  if (name == "mat") return RecordFormat::kMat5;
  if (name == "mat73") return RecordFormat::kMat73;
  return RecordFormat::kCsv;
}

std::string Extension(RecordFormat format) {
  return format == RecordFormat::kCsv ? ".csv" : ".mat";
}

}  // namespace mjdiag::app
