#pragma once
// Numbers as they lie in memory, one behind the other: for files and messages between
// programs on computers of a kind.

#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace mjdiag {

template <typename Number>
void AppendBytes(const Number& number, std::string& bytes) {
  static_assert(std::is_trivially_copyable_v<Number>);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Takes a number off the begin; the caller knows that it is there.
template <typename Number>
Number TakeNumber(std::string_view& bytes) {
  static_assert(std::is_trivially_copyable_v<Number>);
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

}  // namespace mjdiag
