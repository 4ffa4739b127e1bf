#include "mjdiag/signals/unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <ostream>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {

static std::ostream& operator<<(std::ostream& stream, const Unit& unit) {
  return stream << unit.factor << " " << unit.si;
}

namespace {

TEST(ParseUnit, UnderstandsPrefixesProductsAndQuotients) {
  const std::pair<const char*, Unit> cases[] = {
      {"m", {1.0, "m"}},
      {"um", {1e-6, "m"}},
      {"\xC2\xB5m", {1e-6, "m"}},
      {"nm", {1e-9, "m"}},
      {"mm", {1e-3, "m"}},
      {"ms", {1e-3, "s"}},
      {"kHz", {1e3, "Hz"}},
      {"MN", {1e6, "N"}},
      {"kg", {1.0, "kg"}},
      {"g", {1e-3, "kg"}},
      {"mg", {1e-6, "kg"}},
      {"mrad", {1e-3, "rad"}},
      {"deg", {std::numbers::pi / 180.0, "rad"}},
      {"N m", {1.0, "N m"}},
      {"N*m", {1.0, "N m"}},
      {"Nm", {1.0, "N m"}},
      {"mN m", {1e-3, "N m"}},
      {"m/s", {1.0, "m/s"}},
      {"mm/s", {1e-3, "m/s"}},
      {"m/s^2", {1.0, "m/s^2"}},
      {"m/s2", {1.0, "m/s^2"}},
      {"m/s/s", {1.0, "m/s^2"}},
      {"m s^-2", {1.0, "m/s^2"}},
      {"N/mm", {1e3, "N/m"}},
      {"mm^2", {1e-6, "m^2"}},
      {"kg m^2", {1.0, "kg m^2"}},
      {"N s/m", {1.0, "N s/m"}},
      {"m^2/Hz", {1.0, "m^2/Hz"}},
      {"1/s", {1.0, "1/s"}},
      {"m/m", {1.0, "1"}},
      {"1", {1.0, "1"}},
      {"-", {1.0, "1"}},
      {"", {1.0, "1"}},
      {" V ", {1.0, "V"}},
  };
  for (const auto& [text, expected] : cases) {
    const Unit unit = ParseUnit(text);
    EXPECT_EQ(unit.si, expected.si) << text;
    EXPECT_DOUBLE_EQ(unit.factor, expected.factor) << text;
  }
}

TEST(ParseUnit, ReadsItsOwnNamesBackUnchanged) {
  for (const char* text : {"um", "m/s^2", "N m", "kg m^2", "1/s^2", "N s/m", "1"}) {
    const std::string si = ParseUnit(text).si;
    EXPECT_EQ(ParseUnit(si), (Unit{1.0, si}));
  }
}

TEST(ParseUnit, RefusesWhatIsNoUnitInOneLine) {
  for (const char* text : {"furlong", "m/", "/s", "m//s", "m^", "m^x", "m^0", "N/A m",
                           "kkg", "k", "xm", "m s s?", "rpm", "^2"}) {
    EXPECT_THAT([&] { ParseUnit(text); },
                testing::ThrowsMessage<InputError>(testing::StartsWith(
                    "unknown unit \"" + std::string(text) + "\"; expected")));
  }
}

}  // namespace
}  // namespace mjdiag
