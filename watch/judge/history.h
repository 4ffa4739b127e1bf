#pragma once
// What was seen of a machine over minutes, days and weeks, in little room: rows of ever
// longer stretches of time, each with least, mean and most of every quantity. Of the last
// quarter of an hour there is a row a second, of the last weeks one every ten minutes; the
// least and the most of every one of them still show what lasted for a single look.

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {

struct HistoryLevel {
  double width = 0.0;    ///< of a row [s]
  std::size_t rows = 0;  ///< kept
};

/// A quarter of an hour, three hours, two days, six weeks.
inline constexpr std::array<HistoryLevel, 4> kHistoryLevels = {
    {{1.0, 900}, {10.0, 1080}, {60.0, 2880}, {600.0, 6048}}};

/// Of a quantity in a stretch; NaN: it was not known.
struct HistoryValue {
  float least = std::numeric_limits<float>::quiet_NaN();
  float mean = std::numeric_limits<float>::quiet_NaN();
  float most = std::numeric_limits<float>::quiet_NaN();
};

struct HistoryRow {
  double time = 0.0;  ///< at which it begins [s since 1970]
  std::uint32_t looks = 0;
  std::vector<HistoryValue> values;
};

/// A history that is whole, and of another machine.
class OtherHistory : public InputError {
 public:
  using InputError::InputError;
};

/// Safe from several threads.
class History {
 public:
  /// @param quantities  names, in the order of the values
  explicit History(std::vector<std::string> quantities);

  /// What was seen at that time. Where the clock was set back, rows that lie behind now
  /// are dropped.
  void Add(double time, std::span<const HistoryValue> values);

  const std::vector<std::string>& quantities() const { return quantities_; }
  /// Rows of a level that begin at `from` or later, the one that is still growing last.
  std::vector<HistoryRow> Rows(std::size_t level, double from = 0.0) const;

  /// All of it as the bytes of a file (docs/watch.md), with whatever else is to be kept.
  std::string ToBytes(const nlohmann::json& kept) const;
  /// Takes the place of what it holds. InputError that begins with `what`: bytes that are
  /// none of a history, or damaged; OtherHistory: of other quantities.
  /// @return what was kept besides
  nlohmann::json Restore(std::string_view bytes, const std::string& what);

 private:
  struct Growing {
    HistoryRow row;
    std::vector<double> sums;
    std::vector<std::int64_t> counts;
  };
  struct Level {
    std::deque<HistoryRow> rows;
    Growing growing;
    bool any = false;  // in what is growing
  };

  void AddTo(Level& level, double width, std::size_t most, double time,
             std::span<const HistoryValue> values);
  static void BeginRow(Level& level, double begin, std::size_t quantities);
  static HistoryRow RowOf(const Growing& growing);

  std::vector<std::string> quantities_;
  std::array<Level, kHistoryLevels.size()> levels_;
  mutable std::mutex mutex_;
};

}  // namespace mjdiag
