#include "app/format.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace mjdiag::app {
namespace {

/// Characters of UTF-8 text, for columns of a terminal.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string Short(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

void Widen(const std::vector<std::string>& cells, std::vector<std::size_t>& widths) {
  widths.resize(std::max(widths.size(), cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    widths[i] = std::max(widths[i], Width(cells[i]));
  }
}

std::string Line(const std::vector<std::string>& cells,
                 const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string pad(widths[i] - Width(cells[i]), ' ');
    line += (i == 0 ? "" : "  ") + (i == 0 ? cells[i] + pad : pad + cells[i]);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

Table::Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void Table::Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

std::string Table::ToString() const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) Widen(row, widths);
  std::string text;
  for (const auto& row : rows_) text += Line(row, widths);
  return text;
}

}  // namespace mjdiag::app
