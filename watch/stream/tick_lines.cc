#include "mjdiag/watch/stream/tick_lines.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "mjdiag/signals/csv_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/unit.h"
#include "mjdiag/watch/stream/packet.h"

namespace mjdiag {
namespace {

constexpr const char* kTickColumn = "tick";
/// What is quoted of a line that is none.
constexpr std::size_t kShown = 40;
/// Beyond that a difference of times is no number of ticks.
constexpr auto kMostTicksApart = static_cast<double>(kMostTicks);

std::string Shown(std::string_view line) {
  std::string text;
  for (const char c : line.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    text += byte >= 0x20 && byte < 0x7f ? c : '?';
  }
  return "'" + text + (line.size() > kShown ? "...'" : "'");
}

std::string_view Trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

bool LooksLikeNames(std::string_view line) {
  const char first = line.front();
  if (first == '"') return true;
  // A number may be written nan or inf.
  return std::isalpha(static_cast<unsigned char>(first)) != 0 &&
         !line.starts_with("nan") && !line.starts_with("NaN") &&
         !line.starts_with("inf");
}

}  // namespace

TickLines::TickLines(const TickLayout& layout, TickSink& sink, StreamCounts& counts)
    : layout_(layout), sink_(sink), counts_(counts) {
  values_.resize(layout.channels.size());
  StandardColumns();
}

void TickLines::StandardColumns() {
  separator_ = ',';
  width_ = 1 + layout_.channels.size();
  tick_.reset();
  time_ = Column{};
  columns_.clear();
  for (std::size_t i = 1; i < width_; ++i) columns_.push_back({i, 1.0});
}

void TickLines::Take(std::string_view line, std::uint32_t stream, double arrived) {
  line = Trim(line);
  if (line.empty() || line.front() == '#') return;
  counts_.packets.fetch_add(1, std::memory_order_relaxed);
  if (stream != stream_) {
    stream_ = stream;
    StandardColumns();
    latest_time_.reset();
  }
  try {
    if (LooksLikeNames(line)) {
      TakeNames(line);
    } else {
      TakeNumbers(line, arrived);
    }
  } catch (const InputError& error) {
    counts_.AddNonsense(error.what());
  }
}

TickLines::Column TickLines::Find(const TickChannel& channel,
                                  const std::vector<std::string>& names,
                                  const std::vector<std::string>& units) const {
  auto found = std::ranges::find(names, channel.column);
  const bool mapped = found != names.end();
  if (!mapped) found = std::ranges::find(names, channel.name);
  if (found == names.end()) {
    throw InputError("line of names", "no column '" + channel.column + "'",
                     "it among " + Listed(names));
  }
  const auto place = static_cast<std::size_t>(found - names.begin());
  const std::string& said = units[place];
  const std::string& text =
      mapped && !channel.column_unit.empty() ? channel.column_unit : said;
  if (text.empty()) return {place, 1.0};
  const Unit unit = ParseUnit(text);
  if (unit.si != ParseUnit(channel.unit).si) {
    throw InputError("line of names, column '" + *found + "'", "in " + text,
                     "a unit of " + channel.unit);
  }
  return {place, unit.factor};
}

void TickLines::TakeNames(std::string_view line) {
  // The reader of records knows what a line of names may look like.
  const auto source = OpenCsv("line of names", std::string(line) + "\n0\n");
  std::vector<std::string> names;
  std::vector<std::string> units;
  for (const SourceColumn& column : source->columns()) {
    names.push_back(column.name);
    units.push_back(column.unit.value_or(""));
  }
  std::vector<Column> columns;
  for (const TickChannel& channel : layout_.channels) {
    columns.push_back(Find(channel, names, units));
  }
  const auto tick = std::ranges::find(names, kTickColumn);
  const bool has_time = std::ranges::find(names, layout_.time.column) != names.end() ||
                        std::ranges::find(names, layout_.time.name) != names.end();
  std::optional<Column> time;
  if (has_time) time = Find(layout_.time, names, units);
  if (!time && tick == names.end()) {
    throw InputError("line of names", "neither a time nor a column 'tick'",
                     "one of them");
  }
  const std::size_t separator = line.find_first_of("\t;");
  separator_ = separator == line.npos ? ',' : line[separator];
  width_ = names.size();
  columns_ = std::move(columns);
  time_ = time;
  tick_.reset();
  if (tick != names.end()) {
    tick_ = Column{static_cast<std::size_t>(tick - names.begin()), 1.0};
  }
}

std::int64_t TickLines::NumberAt(double time) {
  if (!latest_time_) {
    latest_time_ = time;
    return latest_;
  }
  const double ticks = (time - *latest_time_) / layout_.sample_time;
  const std::int64_t number = std::abs(ticks) < kMostTicksApart
                                  ? latest_ + std::llround(ticks)
                                  : kMostTicks + 1;
  if (number < -kMostTicks || number > kMostTicks) {
    throw InputError("line", "a time of " + std::to_string(time) + " s",
                     "one that follows those before");
  }
  if (time > *latest_time_) {
    latest_time_ = time;
    latest_ = number;
  }
  return number;
}

void TickLines::TakeNumbers(std::string_view line, double arrived) {
  cells_.clear();
  std::string_view rest = line;
  for (bool more = true; more;) {
    const std::size_t end = rest.find(separator_);
    const std::string_view cell = Trim(rest.substr(0, end));
    more = end != std::string_view::npos;
    if (more) rest.remove_prefix(end + 1);
    const auto number = ParseNumber(cell);
    if (!number && !cell.empty()) {
      throw InputError("line " + Shown(line), "no number " + Shown(cell),
                       std::to_string(width_) + " numbers");
    }
    cells_.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  if (cells_.size() != width_) {
    throw InputError("line " + Shown(line), std::to_string(cells_.size()) + " numbers",
                     std::to_string(width_));
  }
  TickHead head;
  head.stream = stream_;
  head.arrived = arrived;
  if (time_) head.sent = time_->factor * cells_[time_->place];
  if (tick_) {
    const double number = cells_[tick_->place];
    if (!(std::abs(number) < kMostTicksApart)) {
      throw InputError("line " + Shown(line), "no number of a tick", "an integer");
    }
    head.number = std::llround(number);
  } else if (std::isfinite(head.sent)) {
    head.number = NumberAt(head.sent);
  } else {
    throw InputError("line " + Shown(line), "no time", "a number of seconds");
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = columns_[i].factor * cells_[columns_[i].place];
  }
  counts_.ticks.fetch_add(1, std::memory_order_relaxed);
  sink_.Add(head, values_);
}

}  // namespace mjdiag
