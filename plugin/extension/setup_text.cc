#include "mjdiag/plugin/extension/setup_text.h"

#include <algorithm>
#include <utility>

#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

std::string TextWithLineEnd(const std::filesystem::path& file) {
  std::string text = ReadTextFile(file);
  if (!text.ends_with('\n')) text += '\n';
  return text;
}

}  // namespace

SetupText::SetupText(const std::filesystem::path& file)
    : text_(TextWithLineEnd(file)), root_(toml::parse(text_, file.string())) {}

toml::node_view<const toml::node> SetupText::At(std::string_view path) const {
  return std::as_const(root_).at_path(path);
}

std::string SetupText::Raw(const toml::node& value) const {
  const std::size_t begin = Position(value.source().begin);
  return text_.substr(begin, Position(value.source().end) - begin);
}

void SetupText::Replace(const toml::node& value, const std::string& text) {
  changes_.Replace(Position(value.source().begin), Position(value.source().end), text);
}

void SetupText::RemoveLines(const toml::node& value) {
  changes_.Replace(LineStart(Position(value.source().begin)),
                   LineEnd(Position(value.source().end)), "");
}

void SetupText::AddBeside(const toml::table& table, const toml::node& neighbour,
                          std::string_view neighbour_key, const std::string& key,
                          const std::string& value) {
  const std::size_t end = Position(neighbour.source().end);
  if (table.is_inline()) {
    changes_.Replace(end, end, ", " + key + " = " + value);
    return;
  }
  // The line up to the value, which has the indentation and any dotted prefix.
  const std::size_t begin = Position(neighbour.source().begin);
  std::string line = text_.substr(LineStart(begin), begin - LineStart(begin));
  line.replace(line.rfind(neighbour_key), neighbour_key.size(), key);
  changes_.Replace(LineEnd(end), LineEnd(end), line + value + "\n");
}

void SetupText::SetBeside(std::string_view neighbour_key, const std::string& key,
                          const std::string& value) {
  if (const auto given = At(key)) {
    Replace(*given.node(), value);
  } else {
    AddBeside(root_, *At(neighbour_key).node(), neighbour_key, key, value);
  }
}

std::size_t SetupText::LineStart(std::size_t at) const {
  return at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;
}

std::size_t SetupText::LineEnd(std::size_t at) const {
  return std::min(text_.find('\n', at), text_.size() - 1) + 1;
}

std::size_t SetupText::Position(const toml::source_position& position) const {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < position.line; ++line) {
    at = text_.find('\n', at) + 1;
  }
  for (toml::source_index column = 1; column < position.column; ++column) {
    ++at;
    while (at < text_.size() && (text_[at] & '\xc0') == '\x80') ++at;
  }
  return at;
}

}  // namespace mjdiag
