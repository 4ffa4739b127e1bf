#include "mjdiag/signals/column_name.h"

#include <utility>

namespace mjdiag {
namespace {

/// Whether brackets hold an index. The unit of a pure number is 1: then the space in front
/// of them tells.
bool IsIndex(std::string_view inside, bool after_space) {
  if (inside.empty() || inside.find_first_not_of("0123456789") != inside.npos) {
    return false;
  }
  return inside != "1" || !after_space;
}

}  // namespace

std::string_view TrimBlanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
    text.remove_prefix(1);
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) {
    text.remove_suffix(1);
  }
  return text;
}

SourceColumn ParseColumnHeader(std::string header) {
  SourceColumn column{std::move(header), {}, std::nullopt};
  const std::string_view text = column.header;
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t at = text.rfind(open);
    if (!text.ends_with(close) || at == std::string_view::npos || at == 0) continue;
    const std::string_view inside =
        TrimBlanks(text.substr(at + 1, text.size() - at - 2));
    if (IsIndex(inside, text[at - 1] == ' ')) break;
    column.unit = inside;
    column.name = TrimBlanks(text.substr(0, at));
    return column;
  }
  column.name = column.header;
  return column;
}

SourceColumn MatrixColumn(const std::string& name, std::size_t index) {
  const std::string number = std::to_string(index);
  return {name + ":" + number, name + "[" + number + "]", std::nullopt};
}

}  // namespace mjdiag
