#pragma once
// The two ways in which mjdiag fails, and nothing else: the input was bad, or the
// numbers went wrong. The command turns them into exit status 2 and 3.

#include <stdexcept>
#include <string>

namespace mjdiag {

/// Bad input or usage (exit status 2). The message is one line that says where, what
/// is wrong there and what was expected.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// "<where>: <what>; expected <expected>"
  InputError(const std::string& where, const std::string& what,
             const std::string& expected)
      : std::runtime_error(where + ": " + what + "; expected " + expected) {}
};

/// The input was good and the computation failed on it: diverged, singular, not
/// converged (exit status 3).
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mjdiag
