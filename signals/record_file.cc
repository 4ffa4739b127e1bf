#include "mjdiag/signals/record_file.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "mjdiag/signals/csv_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/foreign_format.h"
#include "mjdiag/signals/hdf5_file.h"
#include "mjdiag/signals/json_file.h"
#include "mjdiag/signals/mat_container.h"
#include "mjdiag/signals/mat_file.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/signals/uniform_time.h"
#include "mjdiag/signals/unit.h"

namespace mjdiag {
namespace {

using Eigen::Index;

constexpr std::string_view kTime = "time";

/// The columns of a file that become the record, the time first.
struct Selection {
  std::vector<std::size_t> columns;
  std::vector<std::string> channels;
  std::vector<Unit> units;
};

class Selector {
 public:
  Selector(std::string file, const RecordSource& source)
      : file_(std::move(file)), source_(source) {}

  Selection Select(const std::optional<ColumnMap>& map) {
    Choose(map ? map->time : ColumnMap().time);
    if (map) {
      for (const ColumnSpec& column : map->columns) Choose(column);
    } else {
      ChooseAll();
    }
    if (selection_.columns.size() < 2) {
      throw InputError(file_, "no channel besides the time", "at least one");
    }
    return std::move(selection_);
  }

 private:
  void Choose(const ColumnSpec& spec) {
    const auto& columns = source_.columns();
    const auto matches = [&](const SourceColumn& column) {
      return column.name == spec.column || column.header == spec.column;
    };
    const auto found = std::find_if(columns.begin(), columns.end(), matches);
    if (found == columns.end()) {
      if (spec.optional) return;
      throw InputError(file_, "no column \"" + spec.column + "\"", ListColumns());
    }
    if (std::count_if(columns.begin(), columns.end(), matches) > 1) {
      throw InputError(file_, "two columns \"" + spec.column + "\"", "one");
    }
    const bool time = selection_.columns.empty();
    const std::string fallback = found->unit.value_or(time ? "s" : "1");
    Add(static_cast<std::size_t>(found - columns.begin()), spec.channel,
        spec.unit.empty() ? fallback : spec.unit);
  }

  /// But what is no series beside the time: texts, gains, names.
  void ChooseAll() {
    const auto times = source_.columns()[selection_.columns.front()].samples;
    for (std::size_t i = 0; i < source_.columns().size(); ++i) {
      const SourceColumn& column = source_.columns()[i];
      if (i == selection_.columns.front() || column.name.empty()) continue;
      if (times && column.samples && 2 * *column.samples <= *times) continue;
      Add(i, column.name, column.unit.value_or("1"));
    }
  }

  void Add(std::size_t column, const std::string& channel, const std::string& unit) {
    const std::string where =
        file_ + ": column \"" + source_.columns()[column].name + "\"";
    try {
      selection_.units.push_back(ParseUnit(unit));
    } catch (const InputError& error) {
      throw InputError(where + ": " + error.what());
    }
    if (selection_.columns.empty() && selection_.units.front().si != "s") {
      throw InputError(where, "time in \"" + unit + "\"", "a unit of time");
    }
    if (std::find(selection_.channels.begin(), selection_.channels.end(), channel) !=
        selection_.channels.end()) {
      throw InputError(where, "a second channel \"" + channel + "\"",
                       "every name once");
    }
    selection_.columns.push_back(column);
    selection_.channels.push_back(channel);
  }

  std::string ListColumns() const {
    std::string list = "one of";
    for (const SourceColumn& column : source_.columns()) {
      list += (&column == &source_.columns().front() ? " " : ", ") + column.name;
    }
    return list;
  }

  std::string file_;
  const RecordSource& source_;
  Selection selection_;
};

/// The columns of a file that were asked for, in SI units.
class SelectedColumns {
 public:
  SelectedColumns(const std::filesystem::path& file,
                  const std::optional<ColumnMap>& map, MissingCells missing)
      : source_(OpenRecordSource(file)),
        selection_(Selector(file.string(), *source_).Select(map)) {
    values_ = source_->Read(selection_.columns, missing);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values_[i] *= selection_.units[i].factor;
    }
  }

  const Eigen::VectorXd& times() const { return values_.front(); }
  /// Where the time of a sample stands.
  std::function<std::string(Index)> Places() const {
    return [this](Index k) { return source_->Place(selection_.columns.front(), k); };
  }
  std::vector<Channel> Channels() const {
    std::vector<Channel> channels;
    for (std::size_t i = 1; i < values_.size(); ++i) {
      channels.push_back({selection_.channels[i], selection_.units[i].si, values_[i]});
    }
    return channels;
  }

 private:
  std::unique_ptr<RecordSource> source_;
  Selection selection_;
  std::vector<Eigen::VectorXd> values_;  ///< the times first
};

std::string At(const std::filesystem::path& file, const Channel& channel) {
  return file.string() + ": channel \"" + channel.name + "\"";
}

void RequireWritable(const std::filesystem::path& file, const Channel& channel) {
  if (channel.name.empty() || channel.name == kTime ||
      channel.name.find_first_of("\r\n") != std::string::npos) {
    throw InputError(At(file, channel), "not a name for a column",
                     "another name than \"time\", on one line");
  }
  Unit unit;
  try {
    unit = ParseUnit(channel.unit);
  } catch (const InputError& error) {
    throw InputError(At(file, channel) + ": " + error.what());
  }
  if (unit.factor != 1.0) {
    throw InputError(At(file, channel), "unit \"" + channel.unit + "\"",
                     "the SI unit \"" + unit.si + "\"");
  }
  for (Index k = 0; k < channel.samples.size(); ++k) {
    if (!std::isfinite(channel.samples[k])) {
      throw InputError(At(file, channel),
                       "sample " + std::to_string(k) + " is not finite",
                       "finite numbers");
    }
  }
}

/// A header has tabs and ends of lines among its control characters, and no others, in
/// whatever encoding; they would be printed as names of columns.
bool BeginsInBinary(std::string_view text) {
  constexpr std::size_t kHeader = 1024;
  return std::ranges::any_of(text.substr(0, kHeader), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0x7f || (byte < 0x20 && (byte < '\t' || byte > '\r'));
  });
}

}  // namespace

std::unique_ptr<RecordSource> OpenRecordSource(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored)) {
    if (DetectMatVersion(file)) return OpenMat(file);
    if (IsHdf5(file)) return OpenHdf5(file);
  }
  std::string text = ReadTextFile(file);
  RefuseForeignFormat(file, text);
  if (text.find('\0') != std::string::npos || BeginsInBinary(text)) {
    throw InputError(file.string(), "unknown format",
                     "CSV, JSON, HDF5 or MAT version 5 or 7.3");
  }
  if (LooksLikeJson(text)) return OpenJson(file, text);
  return OpenCsv(file, std::move(text));
}

Record ReadRecord(const std::filesystem::path& file,
                  const std::optional<ColumnMap>& map) {
  const SelectedColumns columns(file, map, MissingCells::kRefused);
  const UniformTime time = FitUniformTime(columns.times(), columns.Places());
  Record record(time.sample_time, time.start);
  for (Channel& channel : columns.Channels()) record.Add(std::move(channel));
  return record;
}

MeasuredFile ReadMeasuredFile(const std::filesystem::path& file,
                              const std::optional<ColumnMap>& map,
                              const Resampling& resampling) {
  const SelectedColumns columns(file, map, MissingCells::kNan);
  return RecordOfColumns({columns.times(), columns.Channels(), columns.Places()},
                         resampling);
}

void WriteRecord(const std::filesystem::path& file, const Record& record,
                 RecordFormat format) {
  if (record.samples() < 2) {
    throw InputError(file.string(),
                     "a record of " + std::to_string(record.samples()) + " samples",
                     "at least two");
  }
  for (const Channel& channel : record.channels()) RequireWritable(file, channel);
  if (format == RecordFormat::kCsv) {
    WriteTextFile(file, FormatCsv(record));
  } else {
    WriteMat(file, record, format);
  }
}

}  // namespace mjdiag
