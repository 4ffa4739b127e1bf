#pragma once
// What a rank reports of its pool, and when: at once if its threads may soon have nothing
// to do, else every second.

#include <chrono>
#include <optional>

#include "mjdiag/studies/cluster/rank_message.h"
#include "mjdiag/studies/cluster/run_pool.h"

namespace mjdiag {

class PoolReport {
 public:
  PoolReport(RunPool& pool, std::uint64_t study) : pool_(pool), study_(study) {}

  /// The report that is due, after waiting so long for one.
  std::optional<RankReport> Next(std::chrono::milliseconds longest);
  /// The runs that no report told of, of a pool that was stopped.
  std::vector<std::int64_t> Rest();
  bool is_prepared() const { return is_prepared_; }
  /// Whether there are runs that no thread has begun: then a message may wait.
  bool has_waiting() const { return has_waiting_; }

 private:
  RunPool& pool_;
  std::uint64_t study_;
  std::vector<std::int64_t> done_;
  std::chrono::steady_clock::time_point last_{};
  bool is_prepared_ = false;
  bool has_waiting_ = false;
  bool has_failed_ = false;
};

/// What was thrown, as a report tells it.
void TellFailure(const std::exception_ptr& failure, RankReport& report);

}  // namespace mjdiag
