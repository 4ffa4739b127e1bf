#pragma once
// A picture in memory, and as a PNG file.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mjdiag {

/// 8-bit RGB, rows from the top, no padding: rgb[3 * (y * width + x) + channel].
struct Image {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::vector<std::uint8_t> rgb;

  bool operator==(const Image&) const = default;
};

/// The bytes of a PNG file.
std::string EncodePng(const Image& image);

/// Writes a PNG under a temporary name that is renamed at the end. InputError if the
/// folder is missing or not writable.
void WritePng(const std::filesystem::path& file, const Image& image);

}  // namespace mjdiag
