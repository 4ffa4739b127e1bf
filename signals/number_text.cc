#include "mjdiag/signals/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace mjdiag {

std::optional<double> ParseNumber(std::string_view text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

std::vector<std::pair<std::string, double>> ParseAssignments(
    std::string_view text, const std::function<void(const std::string& what)>& fail) {
  std::vector<std::pair<std::string, double>> all;
  while (!text.empty()) {
    const std::string item(text.substr(0, text.find(',')));
    const std::size_t equals = item.find('=');
    if (equals == item.npos) fail("'" + item + "' has no value");
    const std::string name = item.substr(0, equals);
    const std::string value = item.substr(equals + 1);
    const std::optional<double> number = ParseNumber(value);
    if (!number) fail("'" + value + "' is not a number");
    if (std::ranges::any_of(all, [&](const auto& one) { return one.first == name; })) {
      fail("'" + name + "' is given twice");
    }
    all.emplace_back(name, *number);
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  return all;
}

std::string AllDigits(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

std::string AllDigits(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : " ") + AllDigits(value);
  }
  return text;
}

}  // namespace mjdiag
