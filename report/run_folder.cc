#include "mjdiag/report/run_folder.h"

#include <algorithm>
#include <string>

#include "mjdiag/report/page/page_document.h"
#include "mjdiag/report/page/page_file.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// In the order of their names.
std::vector<fs::path> PageFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().ends_with(kPageEnding)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string NameOf(const fs::path& folder) {
  const fs::path whole = fs::weakly_canonical(folder);
  return whole.has_filename() ? whole.filename().string() : whole.string();
}

}  // namespace

Report ReadRunFolder(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string(), "no such folder",
                     "the folder that --out of a command named");
  }
  Report report;
  report.title = "Report of " + NameOf(folder);
  for (const fs::path& file : PageFiles(folder)) {
    report.pages.push_back(ReadPageDocument(file));
  }
  if (report.pages.empty()) {
    throw InputError(folder.string(), "nothing to report",
                     std::string("at least one *") + kPageEnding +
                         ", as diagnose, compare, discover, design and study write it");
  }
  PutWorstFirst(report.pages);
  report.clip = ReadClipOf(folder);
  return report;
}

}  // namespace mjdiag
