#include "mjdiag/signals/csv_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "mjdiag/signals/column_name.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

using Eigen::Index;

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kNotChosen = std::numeric_limits<std::size_t>::max();

bool IsBlank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

/// Takes the text up to the end of the line off `rest`; counts the line.
std::string_view TakeLine(std::string_view& rest, std::size_t& line_number) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_number;
  return line;
}

/// Takes the next cell off `rest`, which becomes null after the last one.
std::string_view TakeCell(std::string_view& rest, char separator) {
  std::size_t from = 0;
  const std::size_t first = rest.find_first_not_of(' ');
  if (first != std::string_view::npos && rest[first] == '"') {
    // Doubled quotes inside close and reopen, so pairs can be skipped one by one.
    from = first;
    while (from < rest.size() && rest[from] == '"') {
      const std::size_t close = rest.find('"', from + 1);
      from = close == std::string_view::npos ? rest.size() : close + 1;
    }
  }
  const std::size_t end = rest.find(separator, from);
  const std::string_view cell = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  return cell;
}

std::string_view Unquote(std::string_view cell) {
  cell = TrimBlanks(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
    cell = cell.substr(1, cell.size() - 2);
  }
  return cell;
}

std::string UnquoteHeader(std::string_view cell) {
  std::string header(TrimBlanks(Unquote(cell)));
  for (std::size_t at = header.find("\"\""); at != std::string::npos;
       at = header.find("\"\"", at + 1)) {
    header.erase(at, 1);
  }
  return header;
}

std::vector<std::string_view> SplitCells(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  do {
    cells.push_back(TakeCell(line, separator));
  } while (line.data() != nullptr);
  return cells;
}

char FindSeparator(std::string_view header) {
  bool quoted = false;
  std::string unquoted;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (!quoted) unquoted += c;
  }
  for (const char separator : {'\t', ';'}) {
    if (unquoted.find(separator) != std::string::npos) return separator;
  }
  return ',';
}

/// None if the cell is not exactly one finite number.
std::optional<double> ParseCell(std::string_view cell) {
  cell = Unquote(cell);
  if (cell.starts_with('+') && !cell.starts_with("+-")) cell.remove_prefix(1);
  const auto number = ParseNumber(cell);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// Nothing, or what programs write for a number that there is not.
bool IsMissing(std::string_view cell) {
  constexpr std::array<std::string_view, 9> kNothing{
      "", "nan", "na", "n/a", "null", "none", "-", "inf", "infinity"};
  std::string text(TrimBlanks(Unquote(cell)));
  std::ranges::transform(text, text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  if (text.size() > 1 && (text.front() == '-' || text.front() == '+')) text.erase(0, 1);
  return std::ranges::find(kNothing, text) != kNothing.end();
}

class CsvSource : public RecordSource {
 public:
  CsvSource(const std::filesystem::path& file, std::string text)
      : file_(file.string()), text_(std::move(text)), body_(text_) {
    if (body_.starts_with(kByteOrderMark)) body_.remove_prefix(kByteOrderMark.size());
    if (IsBlank(body_)) {
      throw InputError(file_, "is empty", "a header row and rows of numbers");
    }
    ReadHeader();
    if (IsBlank(body_)) {
      throw InputError(file_, "has a header row only", "at least two rows of numbers");
    }
  }

  const std::vector<SourceColumn>& columns() const override { return columns_; }

  std::vector<Eigen::VectorXd> Read(std::span<const std::size_t> chosen,
                                    MissingCells missing) override {
    const Index capacity = std::count(body_.begin(), body_.end(), '\n') + 1;
    std::vector<Eigen::VectorXd> values(chosen.size(), Eigen::VectorXd(capacity));
    std::vector<std::size_t> slots(columns_.size(), kNotChosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) slots[chosen[i]] = i;

    lines_.clear();
    std::string_view rest = body_;
    std::size_t line_number = header_line_;
    while (!rest.empty()) {
      const std::string_view line = TakeLine(rest, line_number);
      if (TrimBlanks(line).empty()) continue;
      if (missing == MissingCells::kNan && IsBlank(rest) && !lines_.empty() &&
          SplitCells(line, separator_).size() < columns_.size()) {
        break;  // cut off while it was written
      }
      lines_.push_back(line_number);
      ReadRow(line, slots, missing, values);
    }
    for (Eigen::VectorXd& column : values) {
      column.conservativeResize(static_cast<Index>(lines_.size()));
    }
    return values;
  }

  std::string Place(std::size_t column, Index sample) const override {
    std::string place = file_;
    if (static_cast<std::size_t>(sample) < lines_.size()) {
      place += ": line " + std::to_string(lines_[static_cast<std::size_t>(sample)]);
    }
    return place + ", column \"" + columns_[column].name + "\"";
  }

 private:
  void ReadHeader() {
    std::string_view line;
    while (!body_.empty() &&
           (TrimBlanks(line).empty() || TrimBlanks(line).starts_with('#'))) {
      line = TakeLine(body_, header_line_);
    }
    if (TrimBlanks(line).empty() || TrimBlanks(line).starts_with('#')) {
      throw InputError(file_, "has comments only", "a header row and rows of numbers");
    }
    separator_ = FindSeparator(line);
    for (const std::string_view cell : SplitCells(line, separator_)) {
      if (ParseCell(cell)) {
        throw InputError(file_ + ": line " + std::to_string(header_line_),
                         "a number in the header row", "names of columns");
      }
      columns_.push_back(ParseColumnHeader(UnquoteHeader(cell)));
    }
  }

  void ReadRow(std::string_view line, const std::vector<std::size_t>& slots,
               MissingCells missing, std::vector<Eigen::VectorXd>& values) const {
    const auto row = static_cast<Index>(lines_.size()) - 1;
    std::string_view rest = line;
    std::size_t column = 0;
    for (; column < slots.size() && rest.data() != nullptr; ++column) {
      const std::string_view cell = TakeCell(rest, separator_);
      if (slots[column] == kNotChosen) continue;
      auto number = ParseCell(cell);
      if (!number && missing == MissingCells::kNan && IsMissing(cell)) {
        number = std::numeric_limits<double>::quiet_NaN();
      }
      if (!number) {
        throw InputError(Place(column, row),
                         "\"" + std::string(TrimBlanks(cell)) + "\"",
                         "a finite number");
      }
      values[slots[column]][row] = *number;
    }
    if (column < slots.size() || rest.data() != nullptr) {
      throw InputError(file_ + ": line " + std::to_string(lines_.back()),
                       std::to_string(SplitCells(line, separator_).size()) + " cells",
                       std::to_string(columns_.size()) + " as the header row has");
    }
  }

  std::string file_;
  std::string text_;
  std::string_view body_;  ///< of text_, what is below the header
  std::size_t header_line_ = 0;
  char separator_ = ',';
  std::vector<SourceColumn> columns_;
  std::vector<std::size_t> lines_;  ///< line number of every row
};

void AppendNumber(std::string& text, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end.ptr);
}

std::string FormatHeader(const std::string& name, const std::string& unit) {
  std::string header = name + " [" + unit + "]";
  if (header.find_first_of(",;\t\"") == std::string::npos) return header;
  std::string quoted = "\"";
  for (const char c : header) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::unique_ptr<RecordSource> OpenCsv(const std::filesystem::path& file,
                                      std::string text) {
  return std::make_unique<CsvSource>(file, std::move(text));
}

std::string FormatCsv(const Record& record) {
  constexpr std::size_t kTypicalNumber = 24;
  std::string text = "time [s]";
  for (const Channel& channel : record.channels()) {
    text += "," + FormatHeader(channel.name, channel.unit);
  }
  text += '\n';
  const Eigen::VectorXd time = record.Time();
  text.reserve(text.size() + static_cast<std::size_t>(time.size()) *
                                 (record.channels().size() + 1) * kTypicalNumber);
  for (Index k = 0; k < time.size(); ++k) {
    AppendNumber(text, time[k]);
    for (const Channel& channel : record.channels()) {
      text += ',';
      AppendNumber(text, channel.samples[k]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mjdiag
