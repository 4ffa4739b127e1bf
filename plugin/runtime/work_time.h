#pragma once
// Seconds that a program has worked: those of the clock, without those in which the computer did
// other things. By the clock alone an answer that a budget ends would depend on what else runs.

#include <chrono>

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

}  // namespace mjdiag
