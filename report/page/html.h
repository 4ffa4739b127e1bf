#pragma once
// Documents of pages as HTML. All text is escaped here and nowhere else.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace mjdiag {

/// Text as it may stand between tags and in quoted attributes.
std::string EscapeHtml(std::string_view text);

/// "<tag>text</tag>" and a line break, the text escaped.
std::string HtmlElement(std::string_view tag, std::string_view text);

/// The verdict of a page (page.h) as a box; nothing without one.
/// @param target  id of the element it links to; empty: none
std::string VerdictHtml(const nlohmann::json& verdict, std::string_view target);

/// Name and value pairs: rows of two texts.
std::string FactsHtml(const nlohmann::json& rows);

/// One block of a page (page.h).
/// @param heading  tag of its headings, "h2" or "h3"
std::string BlockHtml(const nlohmann::json& block, std::string_view heading);

}  // namespace mjdiag
