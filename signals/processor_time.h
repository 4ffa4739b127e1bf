#pragma once
// Time that processors worked, which does not know how busy a computer is otherwise.

#include <ctime>

namespace mjdiag {

/// Of a POSIX clock [s].
inline double TimeOf(clockid_t clock) noexcept {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Of this thread [s].
inline double ThreadTime() noexcept { return TimeOf(CLOCK_THREAD_CPUTIME_ID); }
/// Of all threads of this process [s].
inline double ProcessTime() noexcept { return TimeOf(CLOCK_PROCESS_CPUTIME_ID); }

}  // namespace mjdiag
