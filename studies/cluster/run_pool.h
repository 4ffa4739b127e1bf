#pragma once
// Threads that make runs, one each at a time, of a queue that another thread fills.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "mjdiag/studies/cluster/rank_message.h"

namespace mjdiag {

/// What a rank does of a study.
struct RankWork {
  /// Once, before the first run, on all threads; calls `check` now and then, and lets
  /// through what that throws.
  std::function<void(const std::function<void()>& check)> prepare;
  /// Makes a run and keeps its result, from any thread.
  std::function<void(std::int64_t run)> make;
};

class RunPool {
 public:
  /// @param threads  0: as many as there are cores for this process
  RunPool(int threads, RankWork work);
  /// As Stop.
  ~RunPool();
  RunPool(const RunPool&) = delete;
  RunPool& operator=(const RunPool&) = delete;

  struct News {
    bool is_ready = false;  ///< prepared
    std::vector<std::int64_t> done;
    std::size_t waiting = 0;     ///< runs that no thread has begun
    std::exception_ptr failure;  ///< the first; runs that had not begun are forgotten
    std::int64_t failed_run = -1;
  };

  int threads() const { return threads_; }
  void Add(const std::vector<RunRange>& runs);
  /// What happened since the last call, waiting so long for something to happen.
  News Wait(std::chrono::milliseconds longest);
  /// Ends what was begun, forgets the rest.
  void Stop();

 private:
  void Begin();
  void Work();
  void Fail(std::int64_t run);

  int threads_;
  RankWork work_;
  std::mutex mutex_;
  std::condition_variable something_to_do_;
  std::condition_variable something_happened_;
  std::deque<RunRange> queue_;
  News news_;
  bool has_news_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace mjdiag
