#include "mjdiag/plugin/setup/toml_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// "<line>: <what>", or nothing.
std::string TroubleOf(const std::string& text) {
  const auto trouble = FindTomlTrouble(text);
  return trouble ? std::to_string(trouble->line) + ": " + trouble->what : "";
}

TEST(TomlText, TakesWhatIsToml) {
  for (const char* text :
       {"", "# µ\r\n",
        "\xEF\xBB\xBF"
        "a = 1",
        "\"µ\".'é' = \"µ\" # µ\n[a.\"µ\"]\n[[b]]",
        "a = [\n  [1, +2],  # µ\n  [ 'x', \"y\" ], { q = { \"z\" = 1, 'w'.v = '' } "
        "},\n]\nb = 1",
        "a = \"\"\"\n\"µ\" \\\"\"\"\"\"\nb = '''\nµ'\n'''\nc = \"\\\\\"",
        "a = \"\"\"x\\\n  y µ\"\"\"", "t = 1979-05-27 07:32:00",
        "a = -1e3\n  [ c . d ]"}) {
    EXPECT_EQ(TroubleOf(text), "") << text;
  }
}

TEST(TomlText, FindsWhatItsParserTakesForImpossible) {
  EXPECT_THAT(TroubleOf("a = 1\nµ = 2"), HasSubstr("2: a character beyond ASCII"));
  EXPECT_THAT(TroubleOf("a = \"\"\"x\\\n  µ\"\"\""), HasSubstr("beyond ASCII behind"));
  EXPECT_THAT(TroubleOf("a = \"\\µ\""), HasSubstr("beyond ASCII behind"));
  EXPECT_THAT(TroubleOf("a = 1\x14"), HasSubstr("control character"));
  EXPECT_THAT(TroubleOf("a = 12\"3µ\""), HasSubstr("within a value"));
  EXPECT_THAT(TroubleOf("a = 1.\"µ\""), HasSubstr("within a value"));
  EXPECT_THAT(TroubleOf("a = [}"), HasSubstr("closes another one"));
  EXPECT_THAT(TroubleOf("a = { b = [1, }"), HasSubstr("closes another one"));
  EXPECT_THAT(TroubleOf("a = 1[['µ"), HasSubstr("within a key or value"));
  EXPECT_THAT(TroubleOf("a = 1979-05-27 0\n"), HasSubstr("half of a time"));
  for (const char* header : {"[.a]", "[[[a]]]", "[]", "[ ]", "[", "[["}) {
    EXPECT_THAT(TroubleOf(header), HasSubstr("without a name")) << header;
  }
}

}  // namespace
}  // namespace mjdiag
