#pragma once
// Ticks as lines of CSV, a line a tick. A line of names, as a record has it, says which
// column is what,
//
//   time [s],x [m],y [m],u_x [N]
//
// its units are converted, columns that nobody asked for are passed over, a column `tick`
// counts the ticks. Without such a line the columns are the time, all readings and all
// commands in the order of the setup and in SI units.
//
// Without a column `tick` the time tells which tick it is: that many sample times after
// the latest one so far, to the nearest. A clock may so run a little fast or slow, and
// tremble by less than half a tick.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/watch/stream/stream_counts.h"
#include "mjdiag/watch/stream/tick.h"
#include "mjdiag/watch/stream/tick_layout.h"

namespace mjdiag {

class TickLines {
 public:
  /// Both outlive it.
  TickLines(const TickLayout& layout, TickSink& sink, StreamCounts& counts);

  /// A line without its end. Blank ones and those that begin with # are passed over; what
  /// is neither names nor numbers is counted as nonsense.
  /// @param stream  of the ticks in it; another one than before: no names are known
  void Take(std::string_view line, std::uint32_t stream, double arrived);

 private:
  struct Column {
    std::size_t place = 0;  // in the line
    double factor = 1.0;    // to SI
  };

  void StandardColumns();
  void TakeNames(std::string_view line);
  /// InputError if the line lacks it.
  Column Find(const TickChannel& channel, const std::vector<std::string>& names,
              const std::vector<std::string>& units) const;
  void TakeNumbers(std::string_view line, double arrived);
  std::int64_t NumberAt(double time);

  const TickLayout& layout_;
  TickSink& sink_;
  StreamCounts& counts_;
  char separator_ = ',';
  std::uint32_t stream_ = 0;
  std::size_t width_ = 0;       // columns of a line
  std::optional<Column> tick_;  // which counts
  std::optional<Column> time_;
  std::vector<Column> columns_;  // of the channels
  std::vector<double> cells_;
  std::vector<double> values_;
  std::int64_t latest_ = 0;            // tick
  std::optional<double> latest_time_;  // [s]
};

}  // namespace mjdiag
