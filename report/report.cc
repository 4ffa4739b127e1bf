#include "mjdiag/report/report.h"

#include <algorithm>
#include <string_view>

#include "mjdiag/report/page/base64.h"
#include "mjdiag/report/page/html.h"
#include "mjdiag/report/page/page_assets.h"
#include "mjdiag/report/page/page_document.h"
#include "mjdiag/report/page/plot_library.h"
#include "mjdiag/report/report_document.h"
#include "mjdiag/report/run_folder.h"
#include "mjdiag/signals/file_replacement.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

using nlohmann::json;

// The browser is told, too, that nothing may come from elsewhere.
constexpr std::string_view kContentPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data:; media-src data:";

constexpr std::string_view kHint =
    "<noscript><p>The plots of this page need JavaScript.</p></noscript>\n"
    "<p class=\"hint\">Drag across a plot to zoom, shift and drag to move, "
    "double-click to see all; on a touch screen pinch and double-tap. "
    "<button type=\"button\" id=\"reset-zoom\">Show all</button></p>\n";

int Rank(const json& page) {
  const json& verdict = page.at("verdict");
  if (verdict.is_null()) return 3;
  const json& tone = verdict.at("tone");
  if (tone == "bad") return 0;
  return tone == "neutral" ? 1 : 2;
}

std::string PartName(std::size_t index) { return "part-" + std::to_string(index + 1); }

/// The clip, or where it is if browsers cannot play it.
std::string ClipHtml(const ClipFile& clip) {
  const std::string caption = EscapeHtml(clip.caption);
  if (!clip.PlaysInBrowsers()) {
    return HtmlElement("p", "Clip: " + clip.name + " in the folder of this report (" +
                                clip.caption + "). It is coded as " + clip.codec +
                                ", which browsers do not play.");
  }
  return "<figure class=\"clip\"><video controls loop muted playsinline "
         "preload=\"auto\" aria-label=\"" +
         caption + "\" src=\"data:video/mp4;base64," + Base64(clip.bytes) +
         "\"></video><figcaption>" + caption + "</figcaption></figure>\n";
}

/// Blocks of all pages; the first plot is preceded by how plots are handled.
class Body {
 public:
  void Add(const json& page, std::string_view heading) {
    for (const json& block : page.at("blocks")) {
      if (block.at("kind") == "plot" && !has_plots_) {
        html_ += kHint;
        has_plots_ = true;
      }
      html_ += BlockHtml(block, heading);
    }
  }
  void Add(std::string_view html) { html_ += html; }
  bool has_plots() const { return has_plots_; }
  const std::string& html() const { return html_; }

 private:
  std::string html_;
  bool has_plots_ = false;
};

/// Every command once, in order, and the programs behind them.
std::string AgainHtml(const Report& report) {
  std::vector<std::string> commands;
  json versions = json::array();
  for (const json& page : report.pages) {
    commands.push_back(page.at("command"));
    for (const json& version : page.at("versions")) {
      if (std::find(versions.begin(), versions.end(), version) == versions.end()) {
        versions.push_back(version);
      }
    }
  }
  if (report.clip) commands.push_back(report.clip->command);
  std::string lines;
  for (auto line = commands.begin(); line != commands.end(); ++line) {
    if (line->empty() || std::find(commands.begin(), line, *line) != line) continue;
    lines += (lines.empty() ? "" : "\n") + *line;
  }
  return HtmlElement("h2", "To do it again") + "<pre><code>" + EscapeHtml(lines) +
         "</code></pre>\n" + FactsHtml(versions);
}

Body BodyOf(const Report& report) {
  Body body;
  const bool several = report.pages.size() > 1;
  for (std::size_t i = 0; i < report.pages.size(); ++i) {
    body.Add(VerdictHtml(report.pages[i].at("verdict"),
                         several ? PartName(i) : std::string()));
  }
  if (report.clip) body.Add(ClipHtml(*report.clip));
  for (std::size_t i = 0; i < report.pages.size(); ++i) {
    const json& page = report.pages[i];
    if (!several) {
      body.Add(page, "h2");
      continue;
    }
    body.Add("<section id=\"" + PartName(i) + "\">\n" +
             HtmlElement("h2", page.at("title").get<std::string>()));
    body.Add(page, "h3");
    body.Add("</section>\n");
  }
  body.Add(AgainHtml(report));
  return body;
}

}  // namespace

void PutWorstFirst(std::vector<json>& pages) {
  std::stable_sort(pages.begin(), pages.end(), [](const json& left, const json& right) {
    return Rank(left) < Rank(right);
  });
}

std::string ReportHtml(const Report& report) {
  const Body body = BodyOf(report);
  PlotLibrary library;
  if (body.has_plots()) library = LoadPlotLibrary();
  const std::string title = EscapeHtml(
      report.pages.size() == 1 ? report.pages.front().at("title").get<std::string>()
                               : report.title);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n";
  html += "<meta charset=\"utf-8\">\n";
  html += R"(<meta http-equiv="Content-Security-Policy" content=")";
  html += kContentPolicy;
  html += "\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += "<meta name=\"color-scheme\" content=\"light dark\">\n";
  html += "<title>" + title + "</title>\n<style>\n" + library.style + "\n";
  html += PageStyle();
  html += "</style>\n</head>\n<body>\n<main>\n<h1>" + title + "</h1>\n" + body.html();
  html += "</main>\n<div id=\"paper\" class=\"paper\" hidden></div>\n";
  if (body.has_plots()) {
    html += "<script>\n" + library.script + "\n</script>\n<script>\n";
    html += PageScript();
    html += "</script>\n";
  }
  html += "</body>\n</html>\n";
  return html;
}

std::string ReportHtml(const Page& page) {
  return ReportHtml(Report{"", {page.document().json}, std::nullopt});
}

std::filesystem::path WriteReport(const std::filesystem::path& folder) {
  const std::string html = ReportHtml(ReadRunFolder(folder));
  std::filesystem::path file = folder / "report.html";
  RemoveAbandonedFiles(folder);
  WriteTextFile(file, html);
  return file;
}

}  // namespace mjdiag
