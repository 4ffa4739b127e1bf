#pragma once
// What a study finds: tables of text and numbers, for people and programs alike.

#include <optional>
#include <string>
#include <utility>
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

/// Points with intervals over a curve, for the page of a study.
struct StudyPlot {
  struct Point {
    double x = 0.0;
    double y = 0.0;
    double low = 0.0;  ///< of the interval of y
    double high = 0.0;
  };
  std::string caption;
  std::string x_quantity;
  std::string y_quantity;
  std::vector<Point> points;
  std::vector<std::pair<double, double>> curve;  ///< what is expected
};

struct StudyTable {
  std::string title;
  std::vector<std::string> columns;  ///< none: there is only a plot
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> notes;  ///< one sentence each
  std::optional<StudyPlot> plot{};
};

}  // namespace mjdiag
