#pragma once
// SIGINT and SIGTERM as a wish: the first asks what runs to end with the answer it has,
// the second ends the process.

namespace mjdiag::app {

/// While it lives, signals are taken that way. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Whether it was asked to end; from any thread.
  static bool IsWished();
  /// Throws Interrupted if it was.
  static void ThrowIfWished();
};

}  // namespace mjdiag::app
