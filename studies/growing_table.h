#pragma once
// Tables whose rows are worked out side by side and shown as they come, in their order.

#include <functional>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "mjdiag/studies/study_table.h"

namespace mjdiag {

/// Is given a table whenever it has got a row more, by one thread at a time.
using RowSink = std::function<void(const StudyTable& so_far)>;

class GrowingTable {
 public:
  /// @param table  without its rows
  /// @param shown  may be none
  GrowingTable(StudyTable table, RowSink shown)
      : table_(std::move(table)), shown_(std::move(shown)) {}

  /// From any thread: the row of that place, which is shown once all before it are
  /// there.
  void Put(std::size_t place, std::vector<Cell> row);
  /// The next row.
  void Add(std::vector<Cell> row) { Put(table_.rows.size(), std::move(row)); }

  /// All rows so far, in their order.
  const StudyTable& table() const { return table_; }

 private:
  std::mutex mutex_;
  StudyTable table_;
  RowSink shown_;
  std::map<std::size_t, std::vector<Cell>> waiting_;
};

/// ParallelFor that begins its tasks in their order, so that the first are finished
/// first.
void ParallelInOrder(int count, const std::function<void(int)>& task,
                     const std::function<void(double fraction)>& progress = {});

}  // namespace mjdiag
