#include "mjdiag/signals/quantity.h"

#include <gtest/gtest.h>

#include <limits>

namespace mjdiag {
namespace {

TEST(Quantity, ReadsBetweenOneAndAThousand) {
  EXPECT_EQ(FormatQuantity(1.0785e-6, "m"), "1.08 µm");
  EXPECT_EQ(FormatQuantity(0.0, "m"), "0 m");
  EXPECT_EQ(FormatQuantity(-0.0325, "V"), "-32.5 mV");
  EXPECT_EQ(FormatQuantity(95.1, "N"), "95.1 N");
  EXPECT_EQ(FormatQuantity(8000.0, "Hz"), "8.00 kHz");
  EXPECT_EQ(FormatQuantity(2.0e-8, "m/s^2"), "20.0 nm/s²");
}

TEST(Quantity, RoundsUpIntoTheNextPrefix) {
  EXPECT_EQ(FormatQuantity(999.6e-6, "m"), "1.00 mm");
  EXPECT_EQ(FormatQuantity(999.4e-6, "m"), "999 µm");
}

TEST(Quantity, LeavesUnitsAloneThatTakeNoPrefix) {
  EXPECT_EQ(FormatQuantity(0.002, "kg"), "0.00200 kg");
  EXPECT_EQ(FormatQuantity(0.002, "m^2"), "0.00200 m²");
  EXPECT_EQ(FormatQuantity(0.002, "1"), "0.00200");
}

TEST(Quantity, WritesNumbersOfAnySize) {
  EXPECT_EQ(FormatNumber(0.0010785), "0.00108");
  EXPECT_EQ(FormatNumber(123456.0), "123456");
  EXPECT_EQ(FormatNumber(1.5e-7), "1.50e-07");
  EXPECT_EQ(FormatNumber(1.0, 1), "1");
  EXPECT_EQ(FormatNumber(std::numeric_limits<double>::infinity()), "∞");
  EXPECT_EQ(FormatNumber(std::numeric_limits<double>::quiet_NaN()), "n/a");
}

TEST(DisplayUnit, ConvertsFromSi) {
  const DisplayUnit unit = ChooseDisplayUnit(0.25, "m");
  EXPECT_EQ(unit.name, "mm");
  EXPECT_EQ(unit.factor, 1e3);
}

}  // namespace
}  // namespace mjdiag
