#pragma once
// A control tick of a running machine as it comes in from outside: which one it is, when
// it was, and the numbers of its channels.

#include <cstdint>
#include <limits>
#include <span>

namespace mjdiag {

struct TickHead {
  /// Of one run of the sender; another one: it has started anew.
  std::uint32_t stream = 0;
  std::int64_t number = 0;  ///< counts control ticks, those that were lost included
  /// When it was, by the clock of the sender [s]; NaN: it has none.
  double sent = std::numeric_limits<double>::quiet_NaN();
  double arrived = 0.0;  ///< when it came in, by our clock [s since 1970, UTC]
};

/// Takes ticks, in whatever order they come. From one thread.
class TickSink {
 public:
  virtual ~TickSink() = default;
  /// @param values  readings, then commands, SI units; NaN: not measured
  virtual void Add(const TickHead& head, std::span<const double> values) = 0;
};

/// Our clock [s since 1970, UTC].
double WallClock();

}  // namespace mjdiag
