#include "mjdiag/report/page/base64.h"

#include <algorithm>
#include <cstdint>

namespace mjdiag {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string Base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::uint32_t byte =
          j < count ? static_cast<unsigned char>(bytes[i + j]) : 0U;
      word = word << 8 | byte;
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += j <= count ? kDigits[word >> (18 - 6 * j) & 63U] : '=';
    }
  }
  return text;
}

bool IsBase64(std::string_view text, std::size_t element_size) {
  if (text.size() % 4 != 0) return false;
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() &&
         text[text.size() - 1 - padding] == '=') {
    ++padding;
  }
  const std::size_t digits = text.size() - padding;
  return (text.size() / 4 * 3 - padding) % element_size == 0 &&
         std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(digits),
                     [](char c) { return kDigits.find(c) != kDigits.npos; });
}

}  // namespace mjdiag
