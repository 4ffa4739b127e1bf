#include "mjdiag/signals/measured_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "mjdiag/signals/bridging.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMostlyMissing = 0.9;
constexpr double kShortEnd = 0.1;  // of a record

std::string Quoted(const std::string& name) { return "'" + name + "'"; }

/// Which rows have a time after all times before it.
SampleMask RowsInTime(const MeasuredColumns& columns) {
  const VectorXd& times = columns.times;
  SampleMask in_time(times.size());
  double latest = -std::numeric_limits<double>::infinity();
  Index last = -1;
  for (Index k = 0; k < times.size(); ++k) {
    in_time[k] = times[k] > latest;
    if (!in_time[k]) continue;
    latest = times[k];
    last = k;
  }
  const Index out = times.size() - in_time.count();
  if (10 * out > times.size()) {
    Index k = 0;
    while (in_time[k]) ++k;
    throw InputError(columns.place(k),
                     "time does not increase here, nor in " + std::to_string(out) +
                         " of " + std::to_string(times.size()) + " rows",
                     "a later time in every row: sort the rows, or split the record "
                     "where its clock begins anew");
  }
  if (last < 0) throw InputError(columns.place(0), "no times", "one in every row");
  return in_time;
}

/// What was left out of a channel, and why.
struct Left {
  std::string channel;
  bool reading = false;
  Index missing = 0;
  Index repeated = 0;
  Index period = 1;
};

/// Which samples of a channel are values of their own.
SampleMask ValidSamples(const VectorXd& times, const Channel& channel,
                        const Resampling& resampling, Left& left) {
  SampleMask valid = channel.samples.array().isFinite();
  left.missing = valid.size() - valid.count();
  if (valid.size() - left.missing < 2) {
    throw InputError("record", Quoted(channel.name) + " has no values",
                     "two at least, or no such column under [record.channels]");
  }
  const auto scale = resampling.readings.find(channel.name);
  left.reading = scale != resampling.readings.end();
  if (left.reading) {
    const FreshSamples found = FindFreshSamples(
        Kept(times, valid), Kept(channel.samples, valid), scale->second);
    left.period = found.period;
    if (found.fresh.size() > 0) {
      left.repeated = found.fresh.size() - found.fresh.count();
      Index next = 0;
      for (Index k = 0; k < valid.size(); ++k) {
        if (valid[k]) valid[k] = found.fresh[next++];
      }
    }
  }
  if (valid.all()) valid.resize(0);
  return valid;
}

void RequireMostOf(const VectorXd& times, const VectorXd& valid,
                   const std::string& channel) {
  const double duration = times[times.size() - 1] - times[0];
  const double missing = FindGaps(valid).total + valid[0] - times[0] +
                         times[times.size() - 1] - valid[valid.size() - 1];
  if (missing <= kMostlyMissing * duration) return;
  throw InputError("record",
                   Quoted(channel) + " is missing for " +
                       FormatNumber(100.0 * missing / duration, 2) + " % of its time",
                   "the parts in which it was measured, as records of their own");
}

/// "'a', 'b' and 5 more" and the largest of their numbers.
struct Group {
  std::vector<std::string> names;
  Index most = 0;

  void Add(const std::string& name, Index number) {
    names.push_back(name);
    most = std::max(most, number);
  }
  std::string Names() const {
    constexpr std::size_t kShown = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
      text += (i > 0 ? ", " : "") + Quoted(names[i]);
    }
    if (names.size() > kShown) {
      text += " and " + std::to_string(names.size() - kShown) + " more";
    }
    return text;
  }
  std::string Verb(const char* one, const char* several) const {
    return names.size() > 1 ? several : one;
  }
  std::string Count() const {
    return (names.size() > 1 ? "up to " : "") + std::to_string(most) + " samples";
  }
};

void AddNotes(const std::vector<Left>& all, std::vector<std::string>& notes) {
  constexpr const char* kRunsOn =
      ": the model runs on there, and they count for nothing";
  Group missing;
  Group held;
  Group repeats;
  std::map<Index, Group> slow;
  for (const Left& left : all) {
    if (left.missing > 0) {
      (left.reading ? missing : held).Add(left.channel, left.missing);
    }
    if (left.repeated == 0) continue;
    (left.period > 1 ? slow[left.period] : repeats).Add(left.channel, left.repeated);
  }
  if (!missing.names.empty()) {
    notes.push_back(missing.Names() + missing.Verb(" has", " have") + " no value at " +
                    missing.Count() + kRunsOn);
  }
  if (!held.names.empty()) {
    notes.push_back(held.Names() + held.Verb(" has", " have") + " no value at " +
                    held.Count() + ": taken from those beside them");
  }
  if (!repeats.names.empty()) {
    notes.push_back(repeats.Names() + repeats.Verb(" repeats", " repeat") +
                    " values while in motion, " + repeats.Count() +
                    " (a sensor or bus slower than the record)" + kRunsOn);
  }
  for (const auto& [period, group] : slow) {
    notes.push_back(group.Names() + group.Verb(" has", " have") +
                    " a new value only once in " + std::to_string(period) +
                    " samples: the others count for nothing");
  }
}

/// Samples at an end that a channel has none of: of a reading only if they are few.
Index AtEnd(const SampleMask& measured, bool reading, bool front) {
  Index count = 0;
  const Index n = measured.size();
  while (count < n && !measured[front ? count : n - 1 - count]) ++count;
  const bool few = static_cast<double>(count) <= kShortEnd * static_cast<double>(n);
  return few || !reading ? count : 0;
}

MeasuredFile WithoutEnds(MeasuredFile file, const std::vector<Left>& all) {
  Index front = 0;
  Index back = 0;
  for (const Left& left : all) {
    const SampleMask& measured = file.record.At(left.channel).measured;
    front = std::max(front, AtEnd(measured, left.reading, true));
    back = std::max(back, AtEnd(measured, left.reading, false));
  }
  if (front + back == 0) return file;
  const Index count = file.record.samples() - front - back;
  if (count < 2) {
    throw InputError("record", "no sample at which all channels have begun",
                     "columns that were recorded at the same time");
  }
  file.record = file.record.Slice(front, count);
  file.notes.push_back("the first " + std::to_string(front) + " and the last " +
                       std::to_string(back) +
                       " samples are left out: not all channels have values there");
  return file;
}

}  // namespace

MeasuredFile RecordOfColumns(const MeasuredColumns& columns,
                             const Resampling& resampling) {
  MeasuredFile file;
  const SampleMask in_time = RowsInTime(columns);
  const VectorXd times = Kept(columns.times, in_time);
  if (times.size() < columns.times.size()) {
    file.notes.push_back(std::to_string(columns.times.size() - times.size()) +
                         " rows are left out: their time is missing or not after that "
                         "of the row before");
  }
  const SampleGrid grid =
      ChooseGrid(times, resampling.sample_time, columns.place, resampling.own_clock);
  file.record = Record(grid.time.sample_time, grid.time.start);
  if (!grid.IsOfFile()) file.notes.push_back(grid.note);
  if (const Gaps gaps = FindGaps(times); gaps.count > 0) {
    file.notes.push_back(std::to_string(gaps.count) +
                         (gaps.count > 1 ? " gaps of up to " : " gap of ") +
                         FormatQuantity(gaps.longest, "s") +
                         (gaps.count > 1 ? ", the first at " : " at ") +
                         FormatQuantity(gaps.first, "s") +
                         ": the model runs on there, and they count for nothing");
  }
  std::vector<Left> left;
  for (const Channel& column : columns.channels) {
    Channel channel{column.name, column.unit, Kept(column.samples, in_time)};
    left.push_back({channel.name});
    const SampleMask valid = ValidSamples(times, channel, resampling, left.back());
    RequireMostOf(times, Kept(times, valid), channel.name);
    const auto course = resampling.courses.find(channel.name);
    Bridged bridged =
        Bridge(times, channel.samples, valid, grid,
               course == resampling.courses.end() ? Course::kSmooth : course->second);
    channel.samples = std::move(bridged.samples);
    channel.measured = std::move(bridged.measured);
    file.record.Add(std::move(channel));
  }
  AddNotes(left, file.notes);
  return WithoutEnds(std::move(file), left);
}

MeasuredFile WithoutRepeats(const Record& record,
                            const std::map<std::string, ReadingScale>& readings) {
  const Resampling resampling{record.sample_time(), {}, readings};
  const VectorXd times = record.Time();
  const SampleGrid grid{
      {record.start_time(), record.sample_time()}, record.samples(), ""};
  MeasuredFile file{Record(record.sample_time(), record.start_time()), {}};
  std::vector<Left> left;
  for (const Channel& channel : record.channels()) {
    const bool said = channel.measured.size() > 0;
    const bool bad = !channel.samples.allFinite();
    if (said || (!bad && !readings.contains(channel.name))) {
      file.record.Add(channel);
      continue;
    }
    left.push_back({channel.name});
    const SampleMask valid = ValidSamples(times, channel, resampling, left.back());
    Bridged bridged = Bridge(times, channel.samples, valid, grid, Course::kStraight);
    file.record.Add(
        {channel.name, channel.unit, bridged.samples, std::move(bridged.measured)});
  }
  AddNotes(left, file.notes);
  return file;
}

}  // namespace mjdiag
