#pragma once
// Numbers as people and files write them.

#include <optional>
#include <string_view>

namespace mjdiag {

/// The number that a text is, all of it, whatever the locale; none if it is not one.
std::optional<double> ParseNumber(std::string_view text);

}  // namespace mjdiag
