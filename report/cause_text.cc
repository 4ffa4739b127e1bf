#include "mjdiag/report/cause_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

/// How a parameter and its interval are written: one unit, one number of decimals.
struct Notation {
  DisplayUnit unit;
  int decimals = 0;
  bool exponent = false;  ///< no prefix brings the value near 1

  std::string Number(double value) const {
    if (!std::isfinite(value)) return FormatNumber(value);
    std::array<char, 352> text{};
    std::snprintf(text.data(), text.size(), exponent ? "%.*e" : "%.*f", decimals,
                  value * unit.factor);
    return text.data();
  }
  std::string WithUnit(const std::string& number) const {
    return unit.name.empty() ? number : number + " " + unit.name;
  }
};

int Magnitude(double value) { return static_cast<int>(std::floor(std::log10(value))); }

Notation NotationOf(const CauseParameter& parameter) {
  constexpr int kMostDecimals = 9;
  const double high = std::isfinite(parameter.high) ? std::abs(parameter.high) : 0.0;
  const double size = std::max(std::abs(parameter.value), high);
  Notation notation{ChooseDisplayUnit(size, parameter.unit)};
  const double shown = size * notation.unit.factor;
  const double half = (parameter.high - parameter.low) / 2.0 * notation.unit.factor;
  if (!std::isfinite(shown) || shown == 0.0) return notation;
  // Without a width four digits of the value.
  const int last =
      std::isfinite(half) && half > 0.0 ? Magnitude(half) - 1 : Magnitude(shown) - 3;
  notation.exponent = shown < 1e-4 || shown >= 1e6;
  const int decimals = notation.exponent ? Magnitude(shown) - last : -last;
  notation.decimals = std::clamp(decimals, 0, kMostDecimals);
  return notation;
}

}  // namespace

std::string CauseName(const Cause& cause) {
  return cause.effect->IsFault() ? cause.name() : cause.name() + " at " + cause.site;
}

std::string GainText(double gain) {
  const double left = 100.0 * std::abs(1.0 - gain);
  const int last = std::isfinite(left) && left > 0.0 ? Magnitude(left) - 1 : 0;
  constexpr int kMostDecimals = 6;
  std::array<char, 352> text{};
  std::snprintf(text.data(), text.size(), "%.*f %%",
                std::clamp(-last, 0, kMostDecimals), 100.0 * gain);
  return text.data();
}

std::string ValueText(const CauseParameter& parameter) {
  const Notation notation = NotationOf(parameter);
  return notation.WithUnit(notation.Number(parameter.value));
}

std::string IntervalText(const CauseParameter& parameter) {
  if (!std::isfinite(parameter.low) && !std::isfinite(parameter.high)) {
    return "not told";
  }
  const Notation notation = NotationOf(parameter);
  return notation.WithUnit(notation.Number(parameter.low) + " to " +
                           notation.Number(parameter.high));
}

}  // namespace mjdiag
