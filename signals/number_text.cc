#include "mjdiag/signals/number_text.h"

#include <charconv>

namespace mjdiag {

std::optional<double> ParseNumber(std::string_view text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

}  // namespace mjdiag
