#include "mjdiag/plugin/setup/toml_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using ::testing::StartsWith;

/// What is said of a text, or nothing.
std::string ComplaintOf(const std::string& text) {
  try {
    TomlDocument("text", text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TomlDocument, TakesWhatIsToml) {
  for (const char* text :
       {"", "# µ\r\n",
        "\xEF\xBB\xBF"
        "a = 1",
        "\"µ\".'é' = \"µ\" # µ\n[a.\"µ\"]\n[[b]]",
        "a = [\n  [1, +2],  # µ\n  [ 'x', \"y\" ], { q = { \"z\" = 1, 'w'.v = '' } "
        "},\n]\nb = 1",
        "a = \"\"\"\n\"µ\" \\\"\"\"\"\"\nb = '''\nµ'\n'''\nc = \"\\\\\"",
        "a = \"\"\"x\\\n  µ\"\"\"", "t = 1979-05-27 07:32:00",
        "a = -1e3\n  [ c . d ]"}) {
    EXPECT_EQ(ComplaintOf(text), "") << text;
  }
}

// Found by fuzzing: each was undefined behaviour of the parser.
TEST(TomlDocument, RefusesWithItsLineWhatItsParserTakesForImpossible) {
  for (const char* line :
       {"µ = 2", "a = \"\\µ\"", "a = 1\x14", "a = 12\"3µ\"", "a = 1.\"µ\"", "a = [}",
        "a = { b = [1, }", "a = 1[['µ", "a = 1979-05-27 0\n", "[.a]", "[[[a]]]", "[]",
        "[ ]", "[", "[["}) {
    EXPECT_THAT(ComplaintOf("b = [\n 1,\n]\n" + std::string(line)), StartsWith("text:"))
        << line;
  }
  EXPECT_THAT(ComplaintOf("b = [\n 1,\n]\nµ = 2\nc = 3"), StartsWith("text:4: "));
}

}  // namespace
}  // namespace mjdiag
