#pragma once
// How the command ends.

namespace mjdiag::app {

enum class ExitStatus {
  kDone = 0,
  kNegative = 1,
  kBadInput = 2,
  kNumericalFailure = 3
};

/// Thrown by a command that ran, wrote everything and has a negative answer.
struct NegativeAnswer {};

}  // namespace mjdiag::app
