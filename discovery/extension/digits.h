#pragma once
// Numbers as text that reads back to the same bits.

#include <array>
#include <charconv>
#include <span>
#include <string>

namespace mjdiag {

/// The shortest text of a finite number that loses nothing.
inline std::string AllDigits(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

/// The same of several, with blanks between.
inline std::string AllDigits(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : " ") + AllDigits(value);
  }
  return text;
}

}  // namespace mjdiag
