#pragma once
// Numbers and tables for people.

#include <cstddef>
#include <string>
#include <vector>

namespace mjdiag::app {

/// Up to six significant digits: "1.2", "6.02e+23".
std::string Short(double value);

/// Cells padded to the widths of their columns, the first to the left, the rest to the
/// right, and a line end.
std::string Line(const std::vector<std::string>& cells,
                 const std::vector<std::size_t>& widths);
/// Widens columns to what a row needs.
void Widen(const std::vector<std::string>& cells, std::vector<std::size_t>& widths);

/// Columns padded to their widest cell, the first to the left, the rest to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header);
  void Add(std::vector<std::string> row);
  std::string ToString() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace mjdiag::app
