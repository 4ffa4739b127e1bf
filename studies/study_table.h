#pragma once
// What a study finds: tables of text and numbers, for people and programs alike.

#include <string>
#include <vector>

namespace mjdiag {

/// A number with its unit, a text, or both: the text is what people read.
struct Cell {
  Cell() = default;
  Cell(std::string words) : text(std::move(words)) {}  // NOLINT: a cell is its text
  Cell(const char* words) : text(words) {}             // NOLINT
  /// Four significant digits for people.
  Cell(double value);  // NOLINT: a cell is its number

  std::string text;
  double number = 0.0;
  bool is_number = false;
};

struct StudyTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> notes;  ///< one sentence each
};

}  // namespace mjdiag
