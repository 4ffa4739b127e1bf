#include "mjdiag/plugin/setup/published_relation_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kText = R"(schema = "mjdiag.published_row/1"
degree = 2
digits = 4
pins = [{ channel = "y", power = 0, value = -50.0 }]
[coefficients]
y = [-50.0, -3.0, -2.0]
u = [1.0]
)";

auto Read(const std::string& text) {
  const test::TemporaryFolder folder;
  return ReadPublishedRelation(folder.Write("published_relation_test.toml", text));
}

std::string ErrorAfter(const std::string& from, const std::string& to) {
  std::string text = kText;
  text.replace(text.find(from), from.size(), to);
  return test::MessageOf<InputError>([&] { Read(text); });
}

TEST(PublishedRelationFile, ReadsWhatItSays) {
  const PublishedRelation relation = Read(kText);
  EXPECT_EQ(relation.degree, 2);
  EXPECT_EQ(relation.digits, 4);
  ASSERT_EQ(relation.pins.size(), 1u);
  EXPECT_EQ(relation.pins[0].channel, "y");
  EXPECT_EQ(relation.pins[0].value, -50.0);
  ASSERT_EQ(relation.polynomials.size(), 2u);
  EXPECT_EQ(relation.polynomials[0].channel, "y");
  EXPECT_THAT(relation.polynomials[0].coefficients, ElementsAre(-50.0, -3.0, -2.0));
}

TEST(PublishedRelationFile, SaysFileLineAndKeyOfWhatIsWrong) {
  EXPECT_THAT(
      ErrorAfter("degree = 2", "degree = 2.5"),
      AllOf(HasSubstr("published_relation_test.toml:2: "), HasSubstr("degree")));
  EXPECT_THAT(ErrorAfter("power = 0", "power = 3"),
              AllOf(HasSubstr("published_relation_test.toml:4: "), HasSubstr("power")));
  EXPECT_THAT(
      ErrorAfter("u = [1.0]", "u = [1.0, 2.0, 3.0, 4.0]"),
      AllOf(HasSubstr("published_relation_test.toml:7: "), HasSubstr("too many")));
  EXPECT_THAT(ErrorAfter("digits = 4", "digits = 4\ndigit = 4"), HasSubstr("digit"));
}

}  // namespace
}  // namespace mjdiag
