#pragma once
// The report of a run: one self-contained HTML page, no network, no second file. The
// verdicts come first, then the clip, then the pages, then how to do it again. It
// follows the reader's light or dark scheme, fits a phone and prints.
//
// A single page becomes a report at once (ReportHtml). What several commands found out
// about a run is kept as pages in the folder of the run (WritePage of page_file.h), of
// which WriteReport makes one report.

#include <filesystem>
#include <string>

#include "mjdiag/report/page/page.h"

namespace mjdiag {

/// The report of one page. InputError if it has plots and the plot library is not
/// installed.
std::string ReportHtml(const Page& page);

/// Makes `<folder>/report.html` of all pages in the folder, the worst verdict first, and
/// its clip. @return its path. InputError as ReadRunFolder, if the plot library is not
/// installed, or if the folder is not writable; an older report is then still whole.
std::filesystem::path WriteReport(const std::filesystem::path& folder);

}  // namespace mjdiag
