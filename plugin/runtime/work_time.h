#pragma once
// Seconds that a program has worked: those of the clock, without those in which the computer did
// other things. By the clock alone an answer that a budget ends would depend on what else runs.

#include <chrono>
#include <functional>
#include <optional>

namespace mjdiag {

class WorkTime {
 public:
  WorkTime();

  /// Since it was made [s]: the lesser of the clock's time and the processor time of all threads
  /// of the process.
  double Seconds() const;

 private:
  std::chrono::steady_clock::time_point begin_;
  double processor_begin_;  // [s]
};

/// Whether the program has worked for more than so many seconds since this was called: an end
/// of what has a budget. Never without one.
std::function<bool()> AfterWork(std::optional<double> seconds);

}  // namespace mjdiag
