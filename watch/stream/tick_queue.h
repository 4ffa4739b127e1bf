#pragma once
// Between the thread that a source fills and the one that judges: ticks in the order in
// which they came, as many as there is room for. Where the judge falls behind, what comes
// is lost in one piece till it has taken what waits, so that between its gaps it sees the
// machine for long.

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include "mjdiag/watch/stream/stream_counts.h"
#include "mjdiag/watch/stream/tick.h"

namespace mjdiag {

/// Some ticks, in memory that is used again.
struct TickBlock {
  std::vector<TickHead> heads;
  std::vector<double> values;  ///< tick by tick

  std::size_t size() const { return heads.size(); }
  std::span<const double> ValuesOf(std::size_t tick, std::size_t channels) const {
    return std::span(values).subspan(tick * channels, channels);
  }
};

class TickQueue final : public TickSink {
 public:
  /// What to do with a tick that there is no room for.
  enum class WhenFull { kLose, kWait };

  /// @param counts  outlives it; counts what is lost
  TickQueue(std::size_t channels, std::size_t capacity, WhenFull when_full,
            StreamCounts& counts);

  void Add(const TickHead& head, std::span<const double> values) override;

  /// All that waits, into a block whose memory it takes in exchange. Waits for the first
  /// one so long [s], and not at all once it is closed.
  void Take(double patience, TickBlock& block);

  /// Nobody takes any more, or nothing more comes: nobody waits.
  void Close();
  /// The most that has waited so far.
  std::size_t deepest() const;
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t channels_;
  std::size_t capacity_;
  WhenFull when_full_;
  StreamCounts& counts_;
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::condition_variable emptied_;
  TickBlock waiting_;
  std::size_t deepest_ = 0;
  bool losing_ = false;
  bool closed_ = false;
};

}  // namespace mjdiag
