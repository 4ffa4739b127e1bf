#include "mjdiag/plugin/runtime/work_time.h"

#include <algorithm>
#include <ctime>

namespace mjdiag {
namespace {

double ProcessorSeconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

WorkTime::WorkTime()
    : begin_(std::chrono::steady_clock::now()), processor_begin_(ProcessorSeconds()) {}

double WorkTime::Seconds() const {
  const std::chrono::duration<double> by_clock =
      std::chrono::steady_clock::now() - begin_;
  return std::min(by_clock.count(), ProcessorSeconds() - processor_begin_);
}

std::function<bool()> AfterWork(std::optional<double> seconds) {
  return [seconds, time = WorkTime()] { return seconds && time.Seconds() > *seconds; };
}

}  // namespace mjdiag
