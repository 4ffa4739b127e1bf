#pragma once
// Three clocks that need not agree: the count of control ticks times the tick of the
// setup, the clock of the sender, and ours. The count rules: filters and twins step by it.
// How far the others are from it is said, so that a stream of another rate is not judged,
// and nobody wonders about the times on the page, which are ours.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/watch/stream/tick.h"

namespace mjdiag {

/// What is known of them; NaN: not yet, or the sender has no clock.
struct ClockReport {
  double sent_rate = 0.0;     ///< time of the sender over that of the count, less 1
  double arrived_rate = 0.0;  ///< ours over that of the count, less 1
  double offset = 0.0;     ///< clock of the sender less ours [s], if it shows the date
  std::int64_t steps = 0;  ///< times that the clock of the sender was set
};

class StreamClock {
 public:
  /// @param sample_time  control tick of the setup [s]
  /// @param live         ticks come as fast as they happen
  StreamClock(double sample_time, bool live);

  /// A new run: rates are taken anew.
  void Begin();
  void Add(const TickHead& head);

  const ClockReport& report() const { return report_; }
  /// Whether the ticks are surely not those of the setup's rate.
  bool wrong_rate() const;
  /// What is worth saying, each a sentence.
  std::vector<std::string> Notes() const;

 private:
  double sample_time_;
  bool live_;
  std::optional<TickHead> first_;  // of the stretch that a rate is taken over
  std::optional<TickHead> last_;
  ClockReport report_;
};

}  // namespace mjdiag
