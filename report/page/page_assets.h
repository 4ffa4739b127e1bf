#pragma once
// The style and script of a page, embedded at build time from page.css and page.js.

#include <string_view>

namespace mjdiag {

std::string_view PageStyle();
std::string_view PageScript();

}  // namespace mjdiag
