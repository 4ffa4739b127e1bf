#include "mjdiag/plugin/setup/toml_text.h"

#include <algorithm>

namespace mjdiag {
namespace {

bool StartsKey(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         c == '_' || c == '-' || c == '"' || c == '\'';
}

bool IsBeyondAscii(char c) { return static_cast<unsigned char>(c) >= 0x80; }

class TomlScanner {
 public:
  explicit TomlScanner(std::string_view text) : text_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  std::optional<TomlTrouble> Scan() {
    bool begins = true;    // nothing but blanks in this line so far
    char previous = '\n';  // that is no blank
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (IsBeyondAscii(c)) {
        return Trouble("a character beyond ASCII that is not in quotes");
      }
      if ((c < ' ' && c != '\t' && c != '\r' && c != '\n') || c == 0x7f) {
        return Trouble("a control character");
      }
      if (c == '"' || c == '\'') {
        const std::string_view before = value_ ? "\n=[," : "\n[,{.";
        if (before.find(previous) == before.npos) {
          return Trouble("a quotation mark within a value");
        }
        if (!SkipString(c)) {
          return Trouble("a character beyond ASCII behind a backslash");
        }
      } else if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '[' && begins && open_.empty()) {
        if (!SkipHeader()) return Trouble("a [table] without a name");
      } else {
        if (c == '[' || c == '{') {
          constexpr std::string_view kBeforeValue = "\n=[,";
          if (!value_ || kBeforeValue.find(previous) == kBeforeValue.npos) {
            return Trouble("a bracket within a key or value");
          }
          open_ += c;
        }
        if (c == ' ' && value_ && IsHalfATime()) return Trouble("half of a time");
        if ((c == ']' && !open_.empty()) || c == '}') {
          if (!open_.ends_with(c == ']' ? '[' : '{')) {
            return Trouble("a bracket that closes another one");
          }
          open_.pop_back();
        }
        NoteValue(c);
        ++at_;
      }
      if (c != ' ' && c != '\t' && c != '\r') previous = c == '#' ? '\n' : c;
      begins = c == '\n' || (begins && (c == ' ' || c == '\t' || c == '\r'));
    }
    return std::nullopt;
  }

 private:
  /// Whether what follows is a value, or a key.
  void NoteValue(char c) {
    if (c == '\n' && open_.empty()) value_ = false;
    if (c == '=' || c == '[' || c == ']' || c == '}') value_ = true;
    if (c == '{' || c == ',') value_ = !open_.ends_with('{');
  }

  /// A date, the blank where we are, and one digit.
  bool IsHalfATime() const {
    constexpr std::size_t kDate = 10;  // "1979-05-27", to the parser "....-..-.."
    if (at_ < kDate || !IsDigit(at_ + 1) || IsDigit(at_ + 2)) return false;
    const std::string_view date = text_.substr(at_ - kDate, kDate);
    return date[4] == '-' && date[7] == '-';
  }
  bool IsDigit(std::size_t at) const {
    return at < text_.size() && text_[at] >= '0' && text_[at] <= '9';
  }

  TomlTrouble Trouble(const std::string& what) const {
    const auto before = text_.substr(0, at_);
    return {1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')), what};
  }

  bool SkipString(char quote) {
    const std::string threefold(3, quote);
    const bool lines = text_.substr(at_).starts_with(threefold);
    const std::string_view close =
        lines ? std::string_view(threefold) : std::string_view(&quote, 1);
    at_ += close.size();
    while (at_ < text_.size() && !text_.substr(at_).starts_with(close)) {
      if (!lines && text_[at_] == '\n') return true;  // the parser ends here
      const bool escape = quote == '"' && text_[at_] == '\\';
      if (escape) {
        const std::size_t next =
            lines ? text_.find_first_not_of(" \t\r\n", at_ + 1) : at_ + 1;
        if (next < text_.size() && IsBeyondAscii(text_[next])) return false;
      }
      at_ += escape ? 2 : 1;
    }
    at_ = std::min(at_ + close.size(), text_.size());
    // Up to two more quotes belong to a text of several lines.
    while (lines && at_ < text_.size() && text_[at_] == quote) ++at_;
    return true;
  }

  /// The brackets and what is before the name; the name is scanned as anything else.
  bool SkipHeader() {
    ++at_;
    if (at_ < text_.size() && text_[at_] == '[') ++at_;
    const std::size_t name =
        std::min(text_.find_first_not_of(" \t", at_), text_.size());
    if (name == text_.size() || !StartsKey(text_[name])) return false;
    at_ = name;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool value_ = false;
  std::string open_;  // brackets of arrays and inline tables
};

}  // namespace

std::optional<TomlTrouble> FindTomlTrouble(std::string_view text) {
  return TomlScanner(text).Scan();
}

}  // namespace mjdiag
