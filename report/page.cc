#include "mjdiag/report/page.h"

#include <string_view>

#include "mjdiag/report/page_assets.h"
#include "mjdiag/report/plot_library.h"

namespace mjdiag {
namespace {

std::string Escape(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// JSON inside a script element: no '<' that could begin "</script>" or "<!--".
std::string EscapeForScript(std::string_view json) {
  std::string escaped;
  escaped.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Element(std::string_view tag, std::string_view text) {
  return "<" + std::string(tag) + ">" + Escape(text) + "</" + std::string(tag) + ">\n";
}

std::string_view ToneName(Tone tone) {
  switch (tone) {
    case Tone::kGood:
      return "good";
    case Tone::kBad:
      return "bad";
    case Tone::kNeutral:
      return "neutral";
  }
  return "";
}

std::string_view ToneMark(Tone tone) {
  switch (tone) {
    case Tone::kGood:
      return "✓";
    case Tone::kBad:
      return "!";
    case Tone::kNeutral:
      return "i";
  }
  return "";
}

// The browser is told, too, that nothing may come from elsewhere.
constexpr std::string_view kContentPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data:; media-src data:";

}  // namespace

Page::Page(std::string title) : title_(std::move(title)) {}

void Page::AddVerdict(Tone tone, const std::string& text) {
  body_ += "<p class=\"verdict " + std::string(ToneName(tone)) +
           "\"><span class=\"mark\" aria-hidden=\"true\">" +
           std::string(ToneMark(tone)) + "</span><span>" + Escape(text) +
           "</span></p>\n";
}

void Page::AddHeading(const std::string& text) { body_ += Element("h2", text); }

void Page::AddParagraph(const std::string& text) { body_ += Element("p", text); }

void Page::AddFacts(const std::vector<std::pair<std::string, std::string>>& facts) {
  body_ += "<dl>\n";
  for (const auto& [name, value] : facts) {
    body_ += Element("dt", name) + Element("dd", value);
  }
  body_ += "</dl>\n";
}

void Page::AddTable(const Table& table) {
  const auto row = [&](std::string_view tag, const auto& cell) {
    body_ += "<tr>";
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      body_ += "<" + std::string(tag) +
               (table.columns[i].number ? " class=\"number\">" : ">") +
               Escape(cell(i)) + "</" + std::string(tag) + ">";
    }
    body_ += "</tr>\n";
  };
  body_ += "<div class=\"table\"><table>\n<thead>";
  row("th", [&](std::size_t i) { return table.columns[i].title; });
  body_ += "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& cells : table.rows) {
    row("td", [&](std::size_t i) { return cells.at(i); });
  }
  body_ += "</tbody></table></div>\n";
}

void Page::AddCode(const std::string& text) {
  body_ += "<pre><code>" + Escape(text) + "</code></pre>\n";
}

void Page::AddPlot(const TimePlot& plot) {
  AddPlotElement(plot.caption, plot.height, DescribePlot(plot));
}

void Page::AddPlot(const SpectrumPlot& plot) {
  AddPlotElement(plot.caption, plot.height, DescribePlot(plot));
}

void Page::AddPlot(const XyPlot& plot) {
  AddPlotElement(plot.caption, plot.height, DescribePlot(plot));
}

void Page::AddPlot(const HistogramPlot& plot) {
  AddPlotElement(plot.caption, plot.height, DescribePlot(plot));
}

void Page::AddPlot(const BodePlot& plot) {
  AddPlotElement(plot.caption, plot.height, DescribePlot(plot));
}

void Page::AddPlotElement(const std::string& caption, int height,
                          const std::string& description) {
  if (!has_plots_) {
    body_ +=
        "<noscript><p>The plots of this page need JavaScript.</p></noscript>\n"
        "<p class=\"hint\">Drag across a plot to zoom, shift and drag to move, "
        "double-click to see all; on a touch screen pinch and double-tap. "
        "<button type=\"button\" id=\"reset-zoom\">Show all</button></p>\n";
  }
  has_plots_ = true;
  const std::string label = Escape(caption);
  body_ += "<figure class=\"plot\"><figcaption>" + label +
           "</figcaption><div class=\"legend\"></div><div class=\"chart\" role=\"img\" "
           "aria-label=\"" +
           label + "\" style=\"height:" + std::to_string(height) +
           "px\"></div><script type=\"application/json\">" +
           EscapeForScript(description) + "</script></figure>\n";
}

std::string Page::Html() const {
  PlotLibrary library;
  if (has_plots_) library = LoadPlotLibrary();
  const std::string title = Escape(title_);
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n";
  html += "<meta charset=\"utf-8\">\n";
  html += "<meta http-equiv=\"Content-Security-Policy\" content=\"";
  html += kContentPolicy;
  html += "\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += "<meta name=\"color-scheme\" content=\"light dark\">\n";
  html += "<title>" + title + "</title>\n<style>\n" + library.style + "\n";
  html += PageStyle();
  html += "</style>\n</head>\n<body>\n<main>\n<h1>" + title + "</h1>\n" + body_;
  html += "</main>\n<div id=\"paper\" class=\"paper\" hidden></div>\n";
  if (has_plots_) {
    html += "<script>\n" + library.script + "\n</script>\n<script>\n";
    html += PageScript();
    html += "</script>\n";
  }
  html += "</body>\n</html>\n";
  return html;
}

}  // namespace mjdiag
