#pragma once
// Physical quantities as people read them: 1.08 um, 32.5 N.

#include <string>

namespace mjdiag {

/// value in SI = value shown / factor, shown in `name`
struct DisplayUnit {
  double factor = 1.0;
  std::string name;  ///< for example "µm", "m/s²"; empty for a pure number
};

/// The prefix with which `magnitude` reads between 1 and 1000, for units that start
/// with a symbol that takes one.
DisplayUnit ChooseDisplayUnit(double magnitude, const std::string& si_unit);

/// Three significant digits and the unit: "1.08 µm".
std::string FormatQuantity(double value, const std::string& si_unit);

/// `digits` significant digits, no exponent between 1e-4 and 1e6.
std::string FormatNumber(double value, int digits = 3);

}  // namespace mjdiag
