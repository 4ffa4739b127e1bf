#include "mjdiag/signals/quantity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace mjdiag {
namespace {

struct DisplayPrefix {
  const char* symbol;
  double factor;
};

constexpr std::array<DisplayPrefix, 8> kDisplayPrefixes = {{{"p", 1e12},
                                              {"n", 1e9},
                                              {"µ", 1e6},
                                              {"m", 1e3},
                                              {"", 1.0},
                                              {"k", 1e-3},
                                              {"M", 1e-6},
                                              {"G", 1e-9}}};

/// "m" of "m/s^2": what the prefix would stand before.
std::string_view FirstSymbol(std::string_view unit) {
  return unit.substr(0, unit.find_first_of(" /^"));
}

// A power (m^2) would take the prefix to that power; kg has one already.
bool TakesPrefix(std::string_view unit) {
  constexpr std::array<std::string_view, 9> kSymbols = {"m", "s", "N",  "A",  "V",
                                                        "W", "J", "Hz", "rad"};
  const std::string_view symbol = FirstSymbol(unit);
  const bool power = symbol.size() < unit.size() && unit[symbol.size()] == '^';
  return !power &&
         std::find(kSymbols.begin(), kSymbols.end(), symbol) != kSymbols.end();
}

std::string WithSuperscripts(std::string unit) {
  for (const auto& [plain, typeset] :
       {std::pair{"^2", "²"}, {"^3", "³"}, {"^4", "⁴"}}) {
    for (auto at = unit.find(plain); at != std::string::npos; at = unit.find(plain)) {
      unit.replace(at, 2, typeset);
    }
  }
  return unit;
}

}  // namespace

DisplayUnit ChooseDisplayUnit(double magnitude, const std::string& si_unit) {
  if (si_unit == "1" || si_unit.empty()) return {1.0, ""};
  const std::string name = WithSuperscripts(si_unit);
  if (!TakesPrefix(si_unit) || !std::isfinite(magnitude) || magnitude == 0.0) {
    return {1.0, name};
  }
  // The largest prefix that leaves at least 1, to the three digits that are shown.
  const DisplayPrefix* best = &kDisplayPrefixes.front();
  for (const DisplayPrefix& prefix : kDisplayPrefixes) {
    if (std::abs(magnitude) * prefix.factor >= 0.9995) best = &prefix;
  }
  return {best->factor, best->symbol + name};
}

std::string FormatQuantity(double value, const std::string& si_unit) {
  const DisplayUnit unit = ChooseDisplayUnit(value, si_unit);
  const std::string number = FormatNumber(value * unit.factor);
  return unit.name.empty() ? number : number + " " + unit.name;
}

std::string FormatNumber(double value, int digits) {
  if (value == 0.0) return "0";
  if (!std::isfinite(value)) return std::isnan(value) ? "n/a" : "∞";
  std::array<char, 64> text;
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e6) {
    std::snprintf(text.data(), text.size(), "%.*e", digits - 1, value);
    return text.data();
  }
  // The exponent after rounding to the digits shown: 999.6 has four before its point.
  std::snprintf(text.data(), text.size(), "%.*e", digits - 1, size);
  const double rounded = std::strtod(text.data(), nullptr);
  const int before_point = static_cast<int>(std::floor(std::log10(rounded))) + 1;
  std::snprintf(text.data(), text.size(), "%.*f", std::max(0, digits - before_point),
                value);
  return text.data();
}

}  // namespace mjdiag
