#include "mjdiag/render/engineering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

std::string Fixed(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

}  // namespace

std::string EngineeringFormat::Number(double value_si) const {
  const double shown = value_si * factor;
  const std::string digits = Fixed(std::abs(shown), decimals);
  const bool is_zero = digits.find_first_not_of("0.") == std::string::npos;
  return (shown < 0.0 && !is_zero ? "\u2212" : "") + digits;
}

EngineeringFormat FormatForPeak(std::string_view si_unit, double peak) {
  return FormatForResolution(si_unit, peak, peak / 100.0);
}

EngineeringFormat FormatForResolution(std::string_view si_unit, double peak,
                                      double resolution) {
  const DisplayUnit shown = ChooseDisplayUnit(peak, std::string(si_unit));
  EngineeringFormat format{shown.name.empty() ? std::string(si_unit) : shown.name,
                           shown.factor, 0};
  const double step = resolution * shown.factor;
  if (step > 0.0) {
    constexpr int kMostDecimals = 9;
    // The slack keeps 0.1 one decimal when it arrives as 0.0999999.
    const double needed = std::ceil(-std::log10(step) - 1e-6);
    format.decimals = std::clamp(static_cast<int>(needed), 0, kMostDecimals);
  }
  return format;
}

EngineeringFormat FormatForPureNumber(double peak, double resolution) {
  constexpr double kLargest = 1e4;
  constexpr double kSmallest = 1e-2;
  int exponent = 0;
  if (peak >= kLargest || (peak > 0.0 && peak < kSmallest)) {
    exponent = 3 * static_cast<int>(std::floor(std::log10(peak) / 3.0));
  }
  const double factor = std::pow(10.0, -exponent);
  EngineeringFormat format =
      FormatForResolution("", peak * factor, resolution * factor);
  format.factor = factor;
  format.unit = "1";
  if (exponent != 0) {
    format.unit = std::string("\u00d710^") + (exponent < 0 ? "\u2212" : "") +
                  std::to_string(std::abs(exponent));
  }
  return format;
}

std::vector<double> RoundTicks(double low, double high, int most) {
  const double decade = std::pow(10.0, std::floor(std::log10((high - low) / most)));
  for (const double step : {1.0, 2.0, 5.0, 10.0, 20.0}) {
    const double spacing = step * decade;
    const double slack = 1e-9 * spacing;
    const double first = std::ceil((low - slack) / spacing);
    const double last = std::floor((high + slack) / spacing);
    if (last - first + 1.0 > most) continue;
    std::vector<double> ticks;
    for (double n = first; n <= last; n += 1.0) ticks.push_back(n * spacing);
    return ticks;
  }
  return {low, high};
}

std::string GroupedNumber(double value) {
  std::string digits = Fixed(value, value == std::floor(value) ? 0 : 1);
  const std::size_t whole = std::min(digits.find('.'), digits.size());
  if (whole < 5) return digits;
  for (std::size_t at = whole; at > 3; at -= 3) digits.insert(at - 3, 1, ' ');
  if (digits.front() == ' ') digits.erase(0, 1);
  return digits;
}

}  // namespace mjdiag
