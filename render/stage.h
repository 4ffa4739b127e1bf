#pragma once
// A step of a production line: a thread that works on one item after another while
// the caller prepares the next.

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace mjdiag {

template <class Item>
class Stage {
 public:
  /// @param most_waiting  items, beside the one that is worked on
  Stage(std::size_t most_waiting, std::function<void(Item&)> work)
      : most_waiting_(most_waiting),
        work_(std::move(work)),
        thread_([this] { Run(); }) {}
  /// Without Finish, what waits is dropped.
  ~Stage() {
    {
      const std::lock_guard lock(mutex_);
      waiting_.clear();
    }
    Join();
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Queues an item and takes its memory; `item` gets that of one already done. Waits
  /// while too many do. Rethrows what went wrong in the thread.
  void Push(Item& item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < most_waiting_ || failure_; });
    if (failure_) std::rethrow_exception(failure_);
    waiting_.push_back(std::move(item));
    item = {};
    if (!done_.empty()) {
      item = std::move(done_.back());
      done_.pop_back();
    }
    changed_.notify_all();
  }

  /// Waits until all is done. Rethrows what went wrong in the thread.
  void Finish() {
    Join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void Join() {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
      changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
  }

  void Run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return !waiting_.empty() || closing_; });
      if (waiting_.empty()) return;
      Item item = std::move(waiting_.front());
      waiting_.pop_front();
      changed_.notify_all();
      lock.unlock();
      std::exception_ptr failure;
      try {
        work_(item);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      if (failure) {
        failure_ = failure;
        changed_.notify_all();
        return;
      }
      done_.push_back(std::move(item));
    }
  }

  std::size_t most_waiting_;
  std::function<void(Item&)> work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  std::vector<Item> done_;
  std::exception_ptr failure_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace mjdiag
