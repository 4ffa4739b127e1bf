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

/// Thrown by a command that was asked to end and wrote the answer it had. Its status is
/// what shells give a command that a signal ended: 128 and the signal's number.
struct Interrupted {
  int signal;
  int Status() const { return 128 + signal; }
};

}  // namespace mjdiag::app
