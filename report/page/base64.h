#pragma once
// Base64 (RFC 4648), in which pages carry samples and clips.

#include <string>
#include <string_view>

namespace mjdiag {

std::string Base64(std::string_view bytes);

/// Whether `text` is what Base64() makes of a whole number of elements of so many
/// bytes.
bool IsBase64(std::string_view text, std::size_t element_size);

}  // namespace mjdiag
