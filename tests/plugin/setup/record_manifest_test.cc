#include "mjdiag/plugin/setup/record_manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

auto Read(const std::string& text) {
  const test::TemporaryFolder folder;
  return ReadRecordManifest(folder.Write("records.toml", text), "data");
}

std::string Refusal(const std::string& text) {
  return test::MessageOf<InputError>([&] { Read(text); });
}

TEST(RecordManifest, SaysWhatEachRecordIsForAndWhatWasSet) {
  const auto records = Read(R"(
[[record]]
file = "a.csv"
set = { "axes.q.feedback.numerator" = [100.0, 2.5], "axes.q.drive_gain" = 0.25 }
[[record]]
file = "b.csv"
role = "validation"
plant = "loaded.xml"
)");
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].file, "data/a.csv");
  EXPECT_TRUE(records[0].fit);
  EXPECT_THAT(records[0].overrides,
              ElementsAre("axes.q.drive_gain=0.25",
                          "axes.q.feedback.numerator=[ 100.0, 2.5 ]"));
  EXPECT_FALSE(records[1].fit);
  EXPECT_EQ(records[0].plant, "");
  EXPECT_EQ(records[1].plant, "loaded.xml");
  EXPECT_THAT(records[1].overrides, ElementsAre());
}

TEST(RecordManifest, HasNumbersOfThePlantOfARecord) {
  const auto records = Read(R"(
[[record]]
file = "a.csv"
numbers = { "mass@load" = 2.5, "damping@q" = 1 }
[[record]]
file = "b.csv"
)");
  EXPECT_THAT(records[0].numbers,
              ElementsAre(std::pair("damping@q", 1.0), std::pair("mass@load", 2.5)));
  EXPECT_TRUE(records[1].numbers.empty());
  EXPECT_THAT(
      Refusal("[[record]]\nfile = \"a.csv\"\nnumbers = { \"mass@load\" = \"2 kg\" }\n"),
      AllOf(HasSubstr("numbers.mass@load"), HasSubstr("is no number")));
}

TEST(RecordManifest, RefusesWhatItCannotMean) {
  EXPECT_THAT(Refusal("[[record]]\nfile = \"a.csv\"\nrole = \"test\"\n"),
              AllOf(HasSubstr("role: is \"test\""), HasSubstr("validation")));
  EXPECT_THAT(
      Refusal("[[record]]\nfile = \"a.csv\"\nset = { \"plant\" = \"b.xml\" }\n"),
      AllOf(HasSubstr("set: changes 'plant'"),
            HasSubstr("`plant` names another plant")));
  EXPECT_THAT(Refusal("[[record]]\nfile = \"a.csv\"\n[[record]]\nfile = \"a.csv\"\n"),
              HasSubstr("named twice"));
  EXPECT_THAT(Refusal("[[record]]\nfile = \"a.csv\"\ngain = 3\n"), HasSubstr("gain"));
  EXPECT_THAT(Refusal("[[record]]\nfile = \"a.csv\"\nrole = \"validation\"\n"),
              HasSubstr("no record to fit"));
}

}  // namespace
}  // namespace mjdiag
