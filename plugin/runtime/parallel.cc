#include "mjdiag/plugin/runtime/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mjdiag {
namespace {

/// Hands out the numbers 0 .. count - 1 and keeps the first exception.
class Queue {
 public:
  Queue(int count, const std::function<void(int)>& task) : count_(count), task_(task) {}

  /// Does one task; false if there is none left.
  bool DoNext() {
    const int number = next_++;
    if (number >= count_) return false;
    try {
      task_(number);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      next_ = count_;
    }
    return true;
  }
  double Fraction() const {
    return static_cast<double>(std::min<int>(next_, count_)) / count_;
  }
  void Rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  int count_;
  const std::function<void(int)>& task_;
  std::atomic<int> next_ = 0;
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

void ParallelFor(int count, const std::function<void(int)>& task,
                 const std::function<void(double fraction)>& progress) {
  Queue queue(count, task);
  const int others =
      std::min(count, static_cast<int>(std::thread::hardware_concurrency())) - 1;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < others; ++i) {
      threads.emplace_back([&queue] {
        while (queue.DoNext()) {
        }
      });
    }
    while (queue.DoNext()) {
      if (progress) progress(queue.Fraction());
    }
  }
  queue.Rethrow();
}

}  // namespace mjdiag
