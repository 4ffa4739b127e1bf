#pragma once
// Where results go: a table for people or one JSON document on stdout, and files in the
// output folder.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "mjdiag/signals/record_file.h"

namespace mjdiag::app {

struct OutputOptions {
  std::string folder;  ///< empty: no files
  bool json = false;
};

void AddOutputOptions(CLI::App& command, OutputOptions& options, bool folder_required);

/// Makes the folder, if one is asked for, before any work is done.
void PrepareOutput(const OutputOptions& options);

/// Writes `<folder>/<name>.json`, if there is a folder, and prints either the document
/// or the text.
void Publish(const OutputOptions& options, const std::string& name,
             const nlohmann::json& document, const std::string& text);

/// "csv", "mat" (v5) or "mat73" to format and file extension.
RecordFormat ParseRecordFormat(const std::string& name);
std::string Extension(RecordFormat format);

}  // namespace mjdiag::app
