#include "mjdiag/studies/study_table.h"

#include <array>
#include <cstdio>

namespace mjdiag {

Cell::Cell(double value) : number(value), is_number(true) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.4g", value);
  text = digits.data();
}

}  // namespace mjdiag
