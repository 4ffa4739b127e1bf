#include "mjdiag/watch/stream/tick_queue.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mjdiag {

TickQueue::TickQueue(std::size_t channels, std::size_t capacity, WhenFull when_full,
                     StreamCounts& counts)
    : channels_(channels), capacity_(capacity), when_full_(when_full), counts_(counts) {
  waiting_.heads.reserve(capacity);
  waiting_.values.reserve(capacity * channels);
}

void TickQueue::Add(const TickHead& head, std::span<const double> values) {
  std::unique_lock lock(mutex_);
  if (when_full_ == WhenFull::kWait) {
    emptied_.wait(lock, [this] { return waiting_.size() < capacity_ || closed_; });
  }
  if (closed_) return;
  losing_ = losing_ || waiting_.size() >= capacity_;
  if (losing_) {
    counts_.no_room.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  waiting_.heads.push_back(head);
  waiting_.values.insert(waiting_.values.end(), values.begin(), values.end());
  deepest_ = std::max(deepest_, waiting_.size());
  if (waiting_.size() == 1) filled_.notify_one();
}

void TickQueue::Take(double patience, TickBlock& block) {
  block.heads.clear();
  block.values.clear();
  block.heads.reserve(capacity_);
  block.values.reserve(capacity_ * channels_);
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, std::chrono::duration<double>(patience),
                   [this] { return waiting_.size() > 0 || closed_; });
  std::swap(block, waiting_);
  losing_ = false;
  emptied_.notify_all();
}

void TickQueue::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  filled_.notify_all();
  emptied_.notify_all();
}

std::size_t TickQueue::deepest() const {
  const std::lock_guard lock(mutex_);
  return deepest_;
}

}  // namespace mjdiag
