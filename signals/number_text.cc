#include "mjdiag/signals/number_text.h"

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
