#pragma once
// Ticks in their order: what came out of it is put back, what came twice is dropped, what
// is missing is named, and a sender that starts anew is noticed.
//
// A tick that comes too early waits for those before it: for so many ticks, or so long
// (OrderOptions); then they are given up as missing. A tick that comes after it was given
// up is late, one that was seen is repeated; both are dropped. A sender has started anew
// where its packets have another stream number while the old stream has been silent for a
// while (till then they are foreign: two senders would drive each other out), or where so
// many ticks, one after the other, are old ones.

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mjdiag/watch/stream/tick.h"

namespace mjdiag {

struct OrderOptions {
  int window = 256;       ///< ticks that one waits for those before it
  double patience = 0.1;  ///< [s] that it does
  double silence = 1.0;   ///< [s] after which another sender may take over
  int old_ticks = 256;    ///< old ones in a row that are a new count
};

/// Takes ticks in their order.
class OrderedSink {
 public:
  virtual ~OrderedSink() = default;
  /// The first tick that follows is that of a run of a sender that is new, or counts anew.
  virtual void OnNewRun() = 0;
  /// So many ticks between the last and the next one are not there.
  virtual void OnMissing(std::int64_t ticks) = 0;
  virtual void OnTick(const TickHead& head, std::span<const double> values) = 0;
};

struct OrderCounts {
  std::int64_t taken = 0;      ///< ticks passed on
  std::int64_t missing = 0;    ///< never came, or late
  std::int64_t gaps = 0;       ///< stretches of those
  std::int64_t reordered = 0;  ///< came after a later one, in time
  std::int64_t repeated = 0;
  std::int64_t late = 0;     ///< of those that are missing: they came when given up
  std::int64_t foreign = 0;  ///< of another sender
  std::int64_t runs = 0;     ///< of senders
};

class TickOrder {
 public:
  /// @param sink  outlives it
  TickOrder(const OrderOptions& options, OrderedSink& sink);

  void Add(const TickHead& head, std::span<const double> values);
  /// Time passes: what waited for too long is passed on.
  void Pass(double now);

  const OrderCounts& counts() const { return counts_; }

 private:
  struct Waiting {
    TickHead head;
    std::vector<double> values;
  };

  void Begin(const TickHead& head);
  void Emit(const TickHead& head, std::span<const double> values);
  void Release();
  void GiveUp();
  void AddOld(const TickHead& head, std::span<const double> values);

  OrderOptions options_;
  OrderedSink& sink_;
  OrderCounts counts_;
  std::optional<std::uint32_t> stream_;
  double last_arrival_ = 0.0;
  std::int64_t next_ = 0;    // that is expected
  std::int64_t newest_ = 0;  // seen
  int old_in_a_row_ = 0;
  std::int64_t last_old_ = 0;
  std::map<std::int64_t, Waiting> waiting_;
  std::vector<std::vector<double>> spare_;  // memory for those that wait
  std::deque<std::pair<std::int64_t, std::int64_t>> given_up_;  // [from, until)
};

}  // namespace mjdiag
