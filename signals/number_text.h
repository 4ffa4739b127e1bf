#pragma once
// Numbers as people and files write them.

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mjdiag {

/// The number that a text is, all of it, whatever the locale; none if it is not one.
std::optional<double> ParseNumber(std::string_view text);

/// The shortest text of a finite number that reads back to the same bits.
std::string AllDigits(double value);
/// The same of several, with blanks between.
std::string AllDigits(std::span<const double> values);

}  // namespace mjdiag
