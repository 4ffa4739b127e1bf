#pragma once
// How a cause and its figures are written: one unit and as many digits as are known.

#include <string>

#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// "coulomb_friction at load", or the name of a fault parameter.
std::string CauseName(const Cause& cause);

/// 1 - after / before in percent, to two digits of what is left: "99.975 %".
std::string GainText(double gain);

/// The value with its unit, to two digits of half the interval's width: "20.39 N".
std::string ValueText(const CauseParameter& parameter);
/// The 95 % interval in the same unit and digits: "20.21 to 20.58 N".
std::string IntervalText(const CauseParameter& parameter);

}  // namespace mjdiag
