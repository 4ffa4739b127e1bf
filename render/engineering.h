#pragma once
// Numbers for people: engineering units, fixed decimals, round axis ticks.

#include <string>
#include <string_view>
#include <vector>

namespace mjdiag {

/// Shows values of one SI unit with one prefix and a fixed number of decimals, so that
/// digits do not jump while a value moves.
struct EngineeringFormat {
  std::string unit;     ///< with prefix, for example "µm"
  double factor = 1.0;  ///< shown number = factor * SI value
  int decimals = 0;

  /// "12.3", with a true minus sign
  std::string Number(double value_si) const;
};

/// The prefix of ChooseDisplayUnit for `peak`, with three significant digits there.
EngineeringFormat FormatForPeak(std::string_view si_unit, double peak);

/// The same, with as many decimals as tell `resolution` [SI unit] apart.
EngineeringFormat FormatForResolution(std::string_view si_unit, double peak,
                                      double resolution);

/// For a pure number, which takes no prefix: the unit is "1", or "×10^3" where the
/// axis counts thousands, and so on for peaks of 10 000 and more or below 0.01.
EngineeringFormat FormatForPureNumber(double peak, double resolution);

/// Multiples of 1, 2 or 5 times 10^n inside low .. high, at most `most` (>= 2) of them.
/// low < high
std::vector<double> RoundTicks(double low, double high, int most);

/// "5000", "20 000": digits in groups of three from five digits on.
std::string GroupedNumber(double value);

}  // namespace mjdiag
