#include "mjdiag/studies/growing_table.h"

#include <atomic>

#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

void GrowingTable::Put(std::size_t place, std::vector<Cell> row) {
  const std::lock_guard lock(mutex_);
  waiting_.emplace(place, std::move(row));
  for (auto next = waiting_.find(table_.rows.size()); next != waiting_.end();
       next = waiting_.find(table_.rows.size())) {
    table_.rows.push_back(std::move(next->second));
    waiting_.erase(next);
    if (shown_) shown_(table_);
  }
}

void ParallelInOrder(int count, const std::function<void(int)>& task,
                     const std::function<void(double fraction)>& progress) {
  std::atomic<int> next = 0;
  ParallelFor(
      count, [&](int) { task(next++); }, progress);
}

}  // namespace mjdiag
