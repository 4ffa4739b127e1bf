#pragma once
// A printed parity relation in a file:
//
//   schema = "mjdiag.published_row/1"
//   degree = 7
//   digits = 4                           # significant digits in print
//   pins = [ { channel = "x", power = 7, value = 0.0 } ]   # make it unique
//   [coefficients]                       # channel = ascending powers of s
//   x = [0.0, 1.837e14]                  # 0: nothing in print to compare with
//   u_x = [-1.584e12]

#include <filesystem>

#include "mjdiag/diagnosis/residuals/published_relation.h"

namespace mjdiag {

/// InputError says file, line and key.
PublishedRelation ReadPublishedRelation(const std::filesystem::path& file);

}  // namespace mjdiag
