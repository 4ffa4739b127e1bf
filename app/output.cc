#include "app/output.h"

#include <cstdio>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag::app {

void AddOutputOptions(CLI::App& command, OutputOptions& options, bool folder_required) {
  CLI::Option* out =
      command.add_option("--out", options.folder, "Folder for the files of this run");
  if (folder_required) out->required();
  command.add_flag("--json", options.json,
                   "Print one JSON document on stdout and nothing else");
}

void PrepareOutput(const OutputOptions& options) {
  if (!options.folder.empty()) MakeOutputFolder(options.folder);
}

void Publish(const OutputOptions& options, const std::string& name,
             const nlohmann::json& document, const std::string& text) {
  const std::string dump =
      document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (!options.folder.empty()) {
    WriteTextFile(std::filesystem::path(options.folder) / (name + ".json"), dump);
  }
  if (std::fputs(options.json ? dump.c_str() : text.c_str(), stdout) < 0 ||
      std::fflush(stdout) != 0) {
    throw InputError("standard output", "cannot be written", "a place for the results");
  }
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
