#pragma once
// The report of a run: one self-contained HTML page, no network, no second file. The
// verdicts come first, then the clip, then the pages, then how to do it again. It
// follows the reader's light or dark scheme, fits a phone and prints.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/report/clip_file.h"
#include "mjdiag/report/page.h"

namespace mjdiag {

struct Report {
  std::string title;                  ///< of several pages; one page has its own
  std::vector<nlohmann::json> pages;  ///< documents (page.h), in this order
  std::optional<ClipFile> clip;
};

/// Pages with the worst verdict first, those without one last; else in their order.
void PutWorstFirst(std::vector<nlohmann::json>& pages);

/// The report. InputError if it has plots and the plot library is not installed.
std::string ReportHtml(const Report& report);

/// The report of one page.
std::string ReportHtml(const Page& page);

}  // namespace mjdiag
