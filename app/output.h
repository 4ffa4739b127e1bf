#pragma once
// Where results go: a table for people or one JSON document on stdout, and files in the
// output folder.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mjdiag/report/page/page.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag::app {

struct OutputOptions {
  std::string folder;  ///< empty: no files
  bool json = false;
  bool report = false;  ///< make report.html of the folder at the end
};

/// What a command adds to the report of its folder.
struct NamedPage {
  std::string name;  ///< of its file, before ".page.json"
  Page page;
};

void AddOutputOptions(CLI::App& command, OutputOptions& options, bool folder_required);

/// `--report`, for commands that have a page. Call after AddOutputOptions.
void AddReportOption(CLI::App& command, OutputOptions& options);

/// `--fields`, which prints what the document of the command has and ends.
/// @param reference  FieldReference (field_reference.h) of its result
void AddFieldsOption(CLI::App& command, std::string (*reference)());

/// Makes the folder, if one is asked for, before any work is done. InputError if it
/// cannot be written to, or a report is wanted and the plot library is not installed.
void PrepareOutput(const OutputOptions& options);

/// From here to Publish, files wait beside their places: the folder is the old one till
/// Publish makes it the new one.
void HoldFiles();

/// What a command that failed leaves behind is nothing: removes files that wait, then the
/// folder that PrepareOutput made, and those above it that it made, as far as they are
/// empty.
void DiscardOutput();

/// Writes `<folder>/<name>.json` and the page, if there is a folder, then the report if
/// one is wanted, and prints either the document or the text. The results are on disk
/// before the report is made, which other files of the folder may spoil.
/// @param page  makes the page, asked only if there is a folder; none: no page
void Publish(const OutputOptions& options, const std::string& name,
             const nlohmann::json& document, const std::string& text,
             const std::function<NamedPage()>& page = {});

/// What one should know about the records that a command read, if anything: `notes` of
/// the document, below the text and on the page.
void AddNotes(const std::vector<std::string>& notes, nlohmann::json& document,
              std::string& text);
void AddNotes(const std::vector<std::string>& notes, Page& page);

/// "csv", "mat" (v5) or "mat73" to format and file extension.
RecordFormat ParseRecordFormat(const std::string& name);
std::string Extension(RecordFormat format);

}  // namespace mjdiag::app
