#pragma once
// What an action says when it fails.

#include <string>

namespace mjdiag::test {

/// The message of the Error that `action` throws.
template <typename Error, typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error of the expected kind";
}

}  // namespace mjdiag::test
