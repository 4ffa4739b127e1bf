#include "mjdiag/report/page/html.h"

namespace mjdiag {
namespace {

using nlohmann::json;

std::string_view TextAt(const json& object, const char* key) {
  return object.at(key).get_ref<const std::string&>();
}

/// JSON inside a script element: no '<' that could begin "</script>" or "<!--".
std::string EscapeForScript(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string_view MarkOf(std::string_view tone) {
  if (tone == "good") return "✓";
  return tone == "bad" ? "!" : "i";
}

std::string TableHtml(const json& block) {
  const json& columns = block.at("columns");
  std::string html;
  const auto row = [&](std::string_view tag, const auto& cell) {
    html += "<tr>";
    for (std::size_t i = 0; i < columns.size(); ++i) {
      html += "<" + std::string(tag) +
              (columns[i].at("number").get<bool>() ? " class=\"number\">" : ">") +
              EscapeHtml(cell(i)) + "</" + std::string(tag) + ">";
    }
    html += "</tr>\n";
  };
  html += "<div class=\"table\"><table>\n<thead>";
  row("th", [&](std::size_t i) { return TextAt(columns[i], "title"); });
  html += "</thead>\n<tbody>\n";
  for (const json& cells : block.at("rows")) {
    row("td", [&](std::size_t i) -> std::string_view {
      return cells.at(i).get_ref<const std::string&>();
    });
  }
  return html + "</tbody></table></div>\n";
}

std::string PlotHtml(const json& block) {
  const std::string label = EscapeHtml(TextAt(block, "caption"));
  const json& plot = block.at("plot");
  return "<figure class=\"plot\"><figcaption>" + label +
         "</figcaption><div class=\"legend\"></div><div class=\"chart\" role=\"img\" "
         "aria-label=\"" +
         label + "\" style=\"height:" + std::to_string(plot.at("height").get<int>()) +
         R"(px"></div><script type="application/json">)" +
         EscapeForScript(plot.dump()) + "</script></figure>\n";
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
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

std::string HtmlElement(std::string_view tag, std::string_view text) {
  const std::string name(tag);
  return "<" + name + ">" + EscapeHtml(text) + "</" + name + ">\n";
}

std::string VerdictHtml(const json& verdict, std::string_view target) {
  if (verdict.is_null()) return "";
  const std::string_view tone = TextAt(verdict, "tone");
  const std::string text = EscapeHtml(TextAt(verdict, "text"));
  return "<p class=\"verdict " + std::string(tone) +
         R"("><span class="mark" aria-hidden="true">)" + std::string(MarkOf(tone)) +
         "</span><span>" +
         (target.empty()
              ? text
              : "<a href=\"#" + std::string(target) + "\">" + text + "</a>") +
         "</span></p>\n";
}

std::string FactsHtml(const json& rows) {
  std::string html = "<dl>\n";
  for (const json& row : rows) {
    html += HtmlElement("dt", row.at(0).get_ref<const std::string&>()) +
            HtmlElement("dd", row.at(1).get_ref<const std::string&>());
  }
  return html + "</dl>\n";
}

std::string BlockHtml(const json& block, std::string_view heading) {
  const std::string_view kind = TextAt(block, "kind");
  if (kind == "heading") return HtmlElement(heading, TextAt(block, "text"));
  if (kind == "paragraph") return HtmlElement("p", TextAt(block, "text"));
  if (kind == "facts") return FactsHtml(block.at("rows"));
  if (kind == "table") return TableHtml(block);
  if (kind == "plot") return PlotHtml(block);
  return "<pre><code>" + EscapeHtml(TextAt(block, "text")) + "</code></pre>\n";
}

}  // namespace mjdiag
