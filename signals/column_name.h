#pragma once
// What the columns of logs are called.

#include <cstddef>
#include <string>
#include <string_view>

#include "mjdiag/signals/record_source.h"

namespace mjdiag {

/// "x [m]" or "x (m)" -> name x, unit m. "q[0]", "q(2)" and "q [0]" are elements of q, not
/// numbers in a unit; "x [1]", with a space, is a pure number.
SourceColumn ParseColumnHeader(std::string header);

/// Column `index` of the matrix `name`, from 0: called "q[0]", and "q:0" as well.
SourceColumn MatrixColumn(const std::string& name, std::size_t index);

/// `text` without blanks at its ends.
std::string_view TrimBlanks(std::string_view text);

}  // namespace mjdiag
