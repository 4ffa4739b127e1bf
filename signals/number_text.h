#pragma once
// Numbers as people and files write them.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mjdiag {

/// The number that a text is, all of it, whatever the locale; none if it is not one.
std::optional<double> ParseNumber(std::string_view text);

/// Names and numbers of "force=2,velocity=0.1", in their order, none of them twice.
/// @param fail  is called with what is wrong with the text, and throws
std::vector<std::pair<std::string, double>> ParseAssignments(
    std::string_view text, const std::function<void(const std::string& what)>& fail);

/// The shortest text of a finite number that reads back to the same bits.
std::string AllDigits(double value);
/// The same of several, with blanks between.
std::string AllDigits(std::span<const double> values);

}  // namespace mjdiag
