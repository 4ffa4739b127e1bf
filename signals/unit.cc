#include "mjdiag/signals/unit.h"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

struct Symbol {
  std::string_view name;
  double factor;
  std::string_view si;
};

constexpr std::array<Symbol, 11> kSymbols{{{"m", 1.0, "m"},
                                           {"s", 1.0, "s"},
                                           {"g", 1e-3, "kg"},
                                           {"kg", 1.0, "kg"},
                                           {"N", 1.0, "N"},
                                           {"A", 1.0, "A"},
                                           {"V", 1.0, "V"},
                                           {"W", 1.0, "W"},
                                           {"Hz", 1.0, "Hz"},
                                           {"rad", 1.0, "rad"},
                                           {"deg", std::numbers::pi / 180.0, "rad"}}};

struct Prefix {
  std::string_view name;
  double factor;
};

// The micro sign and the Greek letter mu both occur in files.
constexpr std::array<Prefix, 7> kPrefixes{{{"n", 1e-9},
                                           {"u", 1e-6},
                                           {"\xC2\xB5", 1e-6},
                                           {"\xCE\xBC", 1e-6},
                                           {"m", 1e-3},
                                           {"k", 1e3},
                                           {"M", 1e6}}};

/// Of a symbol, in all: no quantity has more.
constexpr int kHighestPower = 12;

struct Factor {
  double scale;
  std::string_view si;
  int power;
};

const Symbol* FindSymbol(std::string_view name) {
  for (const Symbol& symbol : kSymbols) {
    if (symbol.name == name) return &symbol;
  }
  return nullptr;
}

/// "um" -> 1e-6 m. A symbol wins over a prefix: "m" is the metre.
std::optional<Factor> ParseSymbol(std::string_view name) {
  if (const Symbol* symbol = FindSymbol(name)) {
    return Factor{symbol->factor, symbol->si, 1};
  }
  for (const Prefix& prefix : kPrefixes) {
    if (!name.starts_with(prefix.name)) continue;
    const Symbol* symbol = FindSymbol(name.substr(prefix.name.size()));
    if (!symbol || symbol->name == "kg") continue;
    // k and g cancel exactly, where 1e-6 * 1e-3 would round.
    if (symbol->name == "g" && prefix.name == "m") return Factor{1e-6, "kg", 1};
    return Factor{prefix.factor * symbol->factor, symbol->si, 1};
  }
  return std::nullopt;
}

/// Splits "s^2", "s2", "s^-1" into symbol and power.
std::optional<std::pair<std::string_view, int>> SplitPower(std::string_view text) {
  const std::size_t digits = text.find_first_of("^-0123456789");
  if (digits == std::string_view::npos) return std::pair{text, 1};
  std::string_view exponent = text.substr(digits);
  if (exponent.starts_with('^')) exponent.remove_prefix(1);
  int power = 0;
  const char* end = exponent.data() + exponent.size();
  const auto [stop, error] = std::from_chars(exponent.data(), end, power);
  if (error != std::errc() || stop != end || power == 0 || power < -kHighestPower ||
      power > kHighestPower) {
    return std::nullopt;
  }
  return std::pair{text.substr(0, digits), power};
}

std::optional<Factor> ParseFactor(std::string_view text) {
  if (text == "1") return Factor{1.0, "", 1};
  const auto split = SplitPower(text);
  if (!split) return std::nullopt;
  std::optional<Factor> factor = ParseSymbol(split->first);
  if (factor) factor->power = split->second;
  return factor;
}

class Product {
 public:
  void Multiply(const Factor& factor, int sign) {
    const int power = sign * factor.power;
    for (int i = 0; i < std::abs(power); ++i) {
      scale_ = power > 0 ? scale_ * factor.scale : scale_ / factor.scale;
    }
    if (factor.si.empty()) return;
    for (auto& [si, exponent] : powers_) {
      if (si == factor.si) {
        exponent += power;
        return;
      }
    }
    powers_.emplace_back(factor.si, power);
  }

  /// None if no number holds its size.
  std::optional<Unit> ToUnit() const {
    if (!std::isnormal(scale_)) return std::nullopt;
    std::string numerator;
    std::string denominator;
    for (const auto& [si, exponent] : powers_) {
      if (exponent == 0) continue;
      if (std::abs(exponent) > kHighestPower) return std::nullopt;
      std::string& side = exponent > 0 ? numerator : denominator;
      if (exponent < 0) {
        side += "/";
      } else if (!side.empty()) {
        side += " ";
      }
      side += si;
      if (std::abs(exponent) > 1) side += "^" + std::to_string(std::abs(exponent));
    }
    return Unit{scale_, (numerator.empty() ? "1" : numerator) + denominator};
  }

 private:
  double scale_ = 1.0;
  std::vector<std::pair<std::string_view, int>> powers_;
};

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::optional<Unit> Parse(std::string_view text) {
  Product product;
  bool divided = false;
  while (true) {
    const std::size_t end = text.find_first_of(" */");
    const std::optional<Factor> factor = ParseFactor(text.substr(0, end));
    if (!factor) return std::nullopt;
    product.Multiply(*factor, divided ? -1 : 1);
    if (end == std::string_view::npos) return product.ToUnit();
    text = Trim(text.substr(end));
    const bool divide = text.starts_with('/');
    if (divided && !divide) return std::nullopt;
    divided = divide;
    if (divide || text.starts_with('*')) text = Trim(text.substr(1));
  }
}

}  // namespace

Unit ParseUnit(std::string_view text) {
  const std::string_view trimmed = Trim(text);
  if (trimmed.empty() || trimmed == "-") return {1.0, "1"};
  if (trimmed == "Nm") return {1.0, "N m"};
  if (std::optional<Unit> unit = Parse(trimmed)) return *std::move(unit);
  throw InputError("unknown unit \"" + std::string(text) +
                   "\"; expected products and quotients of m, s, g, N, A, V, W, Hz, "
                   "rad, deg, 1 with prefixes n, u, m, k, M, for example \"um\", "
                   "\"N m\" or \"m/s^2\"");
}

}  // namespace mjdiag
