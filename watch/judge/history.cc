#include "mjdiag/watch/judge/history.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_bytes.h"

namespace mjdiag {
namespace {

constexpr std::string_view kMagic = "mjdiag.history/1 ";

/// Of Fowler, Noll and Vo: tells a file that is cut or damaged, not one that is forged.
std::uint64_t Checksum(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  }
  return hash;
}

float Least(float a, float b) { return std::isnan(a) || b < a ? b : a; }
float Most(float a, float b) { return std::isnan(a) || b > a ? b : a; }

}  // namespace

History::History(std::vector<std::string> quantities)
    : quantities_(std::move(quantities)) {}

void History::Add(double time, std::span<const HistoryValue> values) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    AddTo(levels_[i], kHistoryLevels[i].width, kHistoryLevels[i].rows, time, values);
  }
}

void History::AddTo(Level& level, double width, std::size_t most, double time,
                    std::span<const HistoryValue> values) {
  const double begin = std::floor(time / width) * width;
  Growing& growing = level.growing;
  if (level.any && begin > growing.row.time) {
    level.rows.push_back(RowOf(growing));
    if (level.rows.size() > most) level.rows.pop_front();
    level.any = false;
  } else if (level.any && begin < growing.row.time) {
    level.any = false;
  }
  if (!level.any) BeginRow(level, begin, values.size());
  ++growing.row.looks;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const HistoryValue& value = values[i];
    if (!std::isfinite(value.mean)) continue;
    HistoryValue& so_far = growing.row.values[i];
    so_far.least = Least(so_far.least, value.least);
    so_far.most = Most(so_far.most, value.most);
    growing.sums[i] += value.mean;
    ++growing.counts[i];
  }
}

void History::BeginRow(Level& level, double begin, std::size_t quantities) {
  Growing& growing = level.growing;
  while (!level.rows.empty() && level.rows.back().time > begin) level.rows.pop_back();
  growing.row = {begin, 0, std::vector<HistoryValue>(quantities)};
  growing.sums.assign(quantities, 0.0);
  growing.counts.assign(quantities, 0);
  level.any = true;
  if (level.rows.empty() || level.rows.back().time != begin) return;
  // It was not over when the file was written.
  growing.row = std::move(level.rows.back());
  level.rows.pop_back();
  for (std::size_t i = 0; i < quantities; ++i) {
    const float mean = growing.row.values[i].mean;
    if (!std::isfinite(mean)) continue;
    growing.counts[i] = growing.row.looks;
    growing.sums[i] = static_cast<double>(mean) * growing.row.looks;
  }
}

HistoryRow History::RowOf(const Growing& growing) {
  HistoryRow row = growing.row;
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    if (growing.counts[i] == 0) continue;
    row.values[i].mean =
        static_cast<float>(growing.sums[i] / static_cast<double>(growing.counts[i]));
  }
  return row;
}

std::vector<HistoryRow> History::Rows(std::size_t level, double from) const {
  const std::lock_guard lock(mutex_);
  const Level& wanted = levels_.at(level);
  const auto first = std::ranges::lower_bound(wanted.rows, from, {}, &HistoryRow::time);
  std::vector<HistoryRow> rows(first, wanted.rows.end());
  if (wanted.any && wanted.growing.row.time >= from)
    rows.push_back(RowOf(wanted.growing));
  return rows;
}

std::string History::ToBytes(const nlohmann::json& kept) const {
  nlohmann::json levels = nlohmann::json::array();
  std::string body;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const std::vector<HistoryRow> rows = Rows(i);
    levels.push_back({{"width", kHistoryLevels[i].width}, {"rows", rows.size()}});
    for (const HistoryRow& row : rows) {
      AppendBytes(row.time, body);
      AppendBytes(row.looks, body);
      for (const HistoryValue& value : row.values) {
        AppendBytes(value.least, body);
        AppendBytes(value.mean, body);
        AppendBytes(value.most, body);
      }
    }
  }
  const nlohmann::json head = {
      {"quantities", quantities_}, {"levels", levels}, {"kept", kept}};
  std::string bytes(kMagic);
  bytes += head.dump() + "\n" + body;
  AppendBytes(Checksum(bytes), bytes);
  return bytes;
}

nlohmann::json History::Restore(std::string_view bytes, const std::string& what) {
  const auto fail = [&what](const std::string& why) {
    throw InputError(what, why, "the history of a watch");
  };
  if (!bytes.starts_with(kMagic)) fail("another file");
  const std::size_t end = bytes.find('\n');
  if (end == bytes.npos || bytes.size() < end + 1 + sizeof(std::uint64_t)) {
    fail("cut off");
  }
  std::string_view last = bytes.substr(bytes.size() - sizeof(std::uint64_t));
  const std::string_view all = bytes.substr(0, bytes.size() - last.size());
  if (TakeNumber<std::uint64_t>(last) != Checksum(all)) fail("damaged or cut off");
  const nlohmann::json head = nlohmann::json::parse(
      all.substr(kMagic.size(), end - kMagic.size()), nullptr, false);
  if (head.is_discarded() || !head.contains("quantities")) fail("damaged");
  if (head["quantities"] != quantities_) {
    throw OtherHistory(what, "it is of other quantities",
                       "the history of this machine, or another folder");
  }
  std::string_view body = all.substr(end + 1);
  const std::size_t row_bytes =
      sizeof(double) + sizeof(std::uint32_t) + 3 * sizeof(float) * quantities_.size();
  const std::lock_guard lock(mutex_);
  levels_ = {};
  for (std::size_t i = 0; i < head["levels"].size(); ++i) {
    const std::size_t rows = head["levels"][i]["rows"];
    if (i >= levels_.size() || head["levels"][i]["width"] != kHistoryLevels[i].width ||
        body.size() < rows * row_bytes) {
      fail("other levels than those of this version");
    }
    for (std::size_t k = 0; k < rows; ++k) {
      const auto time = TakeNumber<double>(body);
      HistoryRow row{time, TakeNumber<std::uint32_t>(body), {}};
      for (std::size_t q = 0; q < quantities_.size(); ++q) {
        const auto least = TakeNumber<float>(body);
        const auto mean = TakeNumber<float>(body);
        row.values.push_back({least, mean, TakeNumber<float>(body)});
      }
      levels_[i].rows.push_back(std::move(row));
    }
  }
  return head["kept"];
}

}  // namespace mjdiag
