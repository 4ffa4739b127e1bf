#pragma once
// Units of measured data: what a unit's name means in SI.

#include <string>
#include <string_view>

namespace mjdiag {

/// value in SI = factor * value in the unit
struct Unit {
  double factor = 1.0;
  std::string si;  ///< name of the SI unit, for example "m" for "um", "N m" for "Nm"

  bool operator==(const Unit&) const = default;
};

/// Understands prefixes (n, u or the micro sign, m, k, M), products ("N m", "N*m",
/// "Nm"), quotients ("m/s", "m/s^2", "m/s/s") and powers ("m^2", "m2", "s^-1") of
/// m, s, g/kg, N, A, V, W, Hz, rad, deg and 1 (also "-" and an empty text), up to the 12th
/// power. "g" is the gram. A product after a quotient ("N/A m") is ambiguous and refused.
/// InputError("unknown unit ...") otherwise.
Unit ParseUnit(std::string_view text);

}  // namespace mjdiag
