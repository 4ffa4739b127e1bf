#pragma once
// A report before it is HTML: pages, and the clip of the run.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/report/clip_file.h"

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

}  // namespace mjdiag
