#pragma once
// What came in so far, counted by the threads that take it and read by any other.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace mjdiag {

class StreamCounts {
 public:
  std::atomic<std::int64_t> bytes = 0;
  std::atomic<std::int64_t> packets = 0;  ///< datagrams, messages, or lines of a stream
  std::atomic<std::int64_t> ticks = 0;    ///< in them, whatever became of them
  std::atomic<std::int64_t> nonsense = 0;  ///< packets and lines that are no ticks
  std::atomic<std::int64_t> no_room = 0;   ///< ticks that the queue had no room for
  std::atomic<std::int64_t> kernel = 0;    ///< datagrams that the system dropped

  /// Counts a packet or line that is none.
  /// @param why  where, what and what was expected
  void AddNonsense(const std::string& why) {
    nonsense.fetch_add(1, std::memory_order_relaxed);
    const std::lock_guard lock(mutex_);
    last_nonsense_ = why;
  }
  std::string last_nonsense() const {
    const std::lock_guard lock(mutex_);
    return last_nonsense_;
  }

 private:
  mutable std::mutex mutex_;
  std::string last_nonsense_;
};

}  // namespace mjdiag
