#include "mjdiag/signals/json_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/signals/column_name.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Json = nlohmann::ordered_json;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostJsonColumns = 10'000;
constexpr const char* kExpectedJson =
    "an object of arrays, an array of objects, or an object a line";
constexpr std::string_view kJsonBlank = " \t\r\n";

std::string Inside(const std::string& group, const std::string& name) {
  return group.empty() ? name : group + "/" + name;
}

bool IsCell(const Json& value) {
  return value.is_number() || value.is_boolean() || value.is_null();
}

double CellOf(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  return value.is_number() ? value.get<double>() : kNoNumber;
}

/// Arrays of arrays and arrays of objects are read sample by sample, arrays of numbers at
/// once; columns are in the order in which they appear.
class JsonTable {
 public:
  explicit JsonTable(std::string file) : file_(std::move(file)) {}

  /// @param value  an object of arrays, or an array of samples
  void Read(const std::string& group, const Json& value, int depth = 0) {
    RequireShallow(depth);
    const std::size_t known = names_.size();
    if (value.is_object()) {
      for (const auto& [name, inner] : value.items()) {
        Read(Inside(group, name), inner, depth + 1);
      }
    } else if (value.is_array()) {
      for (std::size_t k = 0; k < value.size(); ++k) {
        ReadSample(group, value[k], k, depth + 1);
      }
      for (std::size_t i = known; i < names_.size(); ++i) {
        cells_of_.at(names_[i]).resize(value.size(), kNoNumber);
      }
    }
  }

  /// The columns of one sample.
  void ReadSample(const std::string& name, const Json& value, std::size_t sample,
                  int depth = 0) {
    RequireShallow(depth);
    if (value.is_object()) {
      for (const auto& [inner, of_inner] : value.items()) {
        ReadSample(Inside(name, inner), of_inner, sample, depth + 1);
      }
    } else if (value.is_array()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        ReadSample(name + "[" + std::to_string(i) + "]", value[i], sample, depth + 1);
      }
    } else if (IsCell(value) && !name.empty()) {
      const auto [found, is_new] = cells_of_.try_emplace(name);
      if (is_new) names_.push_back(name);
      if (names_.size() > kMostJsonColumns) Refuse("more than 10000 columns");
      found->second.resize(sample, kNoNumber);
      found->second.push_back(CellOf(value));
    }
  }

  void FillUpTo(std::size_t samples) {
    for (auto& [name, cells] : cells_of_) cells.resize(samples, kNoNumber);
  }

  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& At(const std::string& name) const {
    return cells_of_.at(name);
  }

 private:
  [[noreturn]] void Refuse(const std::string& what) const {
    throw InputError(file_, what, kExpectedJson);
  }
  void RequireShallow(int depth) const {
    constexpr int kDeepest = 20;
    if (depth > kDeepest) Refuse("nests deeper than a log does");
  }

  std::string file_;
  std::vector<std::string> names_;
  std::map<std::string, std::vector<double>> cells_of_;
};

/// "q[2]" is also called "q:2".
SourceColumn ColumnCalled(const std::string& name) {
  SourceColumn column = ParseColumnHeader(name);
  const std::size_t open = column.name.rfind('[');
  if (open == std::string::npos || open == 0 || !column.name.ends_with(']')) {
    return column;
  }
  column.header = column.name.substr(0, open) + ":" +
                  column.name.substr(open + 1, column.name.size() - open - 2);
  return column;
}

/// What Python writes for numbers that are none is not JSON: null in its place.
std::string WithoutNotANumber(std::string_view text) {
  constexpr std::array<std::string_view, 3> kNone{"-Infinity", "Infinity", "NaN"};
  std::string json;
  json.reserve(text.size());
  bool quoted = false;
  while (!text.empty()) {
    std::size_t taken = 1;
    std::string_view put = text.substr(0, 1);
    if (quoted && text.front() == '\\') {
      put = text.substr(0, 2);
      taken = put.size();
    } else if (text.front() == '"') {
      quoted = !quoted;
    } else if (!quoted) {
      for (const std::string_view none : kNone) {
        if (!text.starts_with(none)) continue;
        put = "null";
        taken = none.size();
        break;
      }
    }
    json += put;
    text.remove_prefix(taken);
  }
  return json;
}

/// Whether an object ends on the first line and there are others behind it.
bool IsOneALine(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kJsonBlank);
  const std::size_t end = text.find('\n', first);
  if (end == text.npos || text.find_first_not_of(kJsonBlank, end) == text.npos) {
    return false;
  }
  return Json::parse(text.substr(first, end - first), nullptr, false).is_object();
}

class JsonSource : public RecordSource {
 public:
  JsonSource(const std::filesystem::path& file, std::string_view text)
      : file_(file.string()), table_(file_) {
    const std::string json = WithoutNotANumber(text);
    IsOneALine(json) ? ReadLines(json) : ReadWhole(json);
    for (const std::string& name : table_.names()) {
      columns_.push_back(ColumnCalled(name));
      if (units_.contains(name) && units_[name].is_string()) {
        columns_.back().unit = units_[name].get<std::string>();
      }
      columns_.back().samples = static_cast<Index>(table_.At(name).size());
    }
    if (columns_.empty()) throw InputError(file_, "has no numbers", kExpectedJson);
  }

  const std::vector<SourceColumn>& columns() const override { return columns_; }

  std::vector<Eigen::VectorXd> Read(std::span<const std::size_t> chosen,
                                    MissingCells missing) override {
    std::vector<Eigen::VectorXd> values;
    for (const std::size_t column : chosen) {
      const std::vector<double>& cells = table_.At(table_.names()[column]);
      values.push_back(Eigen::Map<const Eigen::VectorXd>(
          cells.data(), static_cast<Index>(cells.size())));
      if (values.back().size() != values.front().size()) {
        throw InputError(file_ + ": \"" + columns_[column].name + "\"",
                         std::to_string(cells.size()) + " samples",
                         std::to_string(values.front().size()) + " as \"" +
                             columns_[chosen.front()].name + "\" has");
      }
      for (Index k = 0; k < values.back().size(); ++k) {
        if (std::isfinite(values.back()[k])) continue;
        if (missing == MissingCells::kRefused) {
          throw InputError(Place(column, k), "no number", "a finite number");
        }
        values.back()[k] = kNoNumber;
      }
    }
    return values;
  }

  std::string Place(std::size_t column, Index sample) const override {
    const auto k = static_cast<std::size_t>(sample);
    return file_ + ": " +
           (k < lines_.size() ? "line " + std::to_string(lines_[k])
                              : "sample " + std::to_string(k)) +
           ", \"" + columns_[column].name + "\"";
  }

 private:
  void ReadWhole(const std::string& text) {
    Json whole;
    try {
      whole = Json::parse(text);
    } catch (const Json::parse_error& error) {
      const auto end =
          text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
      throw InputError(
          file_ + ": line " + std::to_string(1 + std::count(text.begin(), end, '\n')),
          "is not JSON", kExpectedJson);
    }
    if (whole.is_object() && whole.contains("units") && whole["units"].is_object()) {
      units_ = whole["units"];
      whole.erase("units");
    }
    table_.Read("", whole);
  }

  void ReadLines(const std::string& text) {
    std::string_view rest = text;
    std::size_t number = 0;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      ++number;
      if (line.find_first_not_of(kJsonBlank) == line.npos) continue;
      const Json sample = Json::parse(line, nullptr, false);
      if (!sample.is_object()) {
        if (sample.is_discarded() && !lines_.empty() &&
            rest.find_first_not_of(kJsonBlank) == rest.npos) {
          break;  // cut off while it was written
        }
        throw InputError(file_ + ": line " + std::to_string(number),
                         sample.is_discarded() ? "is not JSON" : "is no object",
                         kExpectedJson);
      }
      table_.ReadSample("", sample, lines_.size());
      lines_.push_back(number);
    }
    table_.FillUpTo(lines_.size());
  }

  std::string file_;
  JsonTable table_;
  Json units_;
  std::vector<SourceColumn> columns_;
  std::vector<std::size_t> lines_;  ///< of every sample, of JSON lines
};

}  // namespace

bool LooksLikeJson(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kJsonBlank);
  if (first == text.npos) return false;
  if (text[first] == '{') return true;
  if (text[first] != '[') return false;
  const std::size_t second = text.find_first_not_of(kJsonBlank, first + 1);
  return second != text.npos && (text[second] == '{' || text[second] == '[');
}

std::unique_ptr<RecordSource> OpenJson(const std::filesystem::path& file,
                                       std::string_view text) {
  return std::make_unique<JsonSource>(file, text);
}

}  // namespace mjdiag
