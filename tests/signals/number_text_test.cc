#include "mjdiag/signals/number_text.h"

#include <gtest/gtest.h>

namespace mjdiag {
namespace {

TEST(NumberText, IsANumberOnlyAsAWhole) {
  EXPECT_EQ(ParseNumber("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(ParseNumber("7"), 7.0);
  for (const char* text : {"", " 1", "1 ", "1,5", "1.5mm", "+1", "one"}) {
    EXPECT_EQ(ParseNumber(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace mjdiag
