#include "mjdiag/report/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/report/page/page_file.h"
#include "mjdiag/report/report.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::string_literals;

Page Judged(const std::string& title, std::optional<Tone> tone) {
  Page page(title);
  if (tone) page.SetVerdict(*tone, "verdict of " + title);
  page.SetRun({"mjdiag " + title, "", {{"mjdiag", "1"}}});
  page.AddHeading("Heading of " + title);
  return page;
}

std::string Box(const std::string& type, const std::string& content) {
  const auto size = static_cast<char>(8 + content.size());
  return "\0\0\0"s + size + type + content;
}

/// The least that looks like a clip of that codec.
std::string Mp4(const std::string& codec) {
  return Box("ftyp", "isom") + Box("mdat", "pictures") + Box("moov", "stsd" + codec);
}

class RunFolder : public ::testing::Test {
 protected:
  void Write(const std::string& name, const Page& page) const {
    WritePage(folder_.path(), name, page);
  }
  std::string Html() const { return ReadTextFile(WriteReport(folder_.path())); }
  std::string Refused() const {
    std::string message =
        test::MessageOf<InputError>([&] { WriteReport(folder_.path()); });
    EXPECT_FALSE(fs::exists(folder_.path() / "report.html"));
    return message;
  }
  const test::TemporaryFolder folder_;
};

TEST_F(RunFolder, PutsTheWorstVerdictFirst) {
  Write("a", Judged("study", std::nullopt));
  Write("b", Judged("good", Tone::kGood));
  Write("c", Judged("partly", Tone::kNeutral));
  Write("d", Judged("worn", Tone::kBad));
  Write("e", Judged("also worn", Tone::kBad));
  const std::string html = Html();
  std::size_t last = 0;
  for (const char* title :
       {"verdict of worn", "verdict of also worn", "verdict of partly",
        "verdict of good", "<h2>worn</h2>", "<h2>also worn</h2>", "<h2>partly</h2>",
        "<h2>good</h2>", "<h2>study</h2>", "<h2>To do it again</h2>"}) {
    const std::size_t at = html.find(title);
    ASSERT_NE(at, std::string::npos) << title;
    EXPECT_GT(at, last) << title;
    last = at;
  }
  EXPECT_THAT(html, HasSubstr("<h3>Heading of worn</h3>"));
  EXPECT_THAT(html, HasSubstr("mjdiag worn\nmjdiag also worn\nmjdiag partly"));
}

TEST_F(RunFolder, OfOnePageIsThatPage) {
  Write("diagnosis", Judged("Diagnosis of slide", Tone::kGood));
  const std::string html = Html();
  EXPECT_THAT(html, HasSubstr("<h1>Diagnosis of slide</h1>"));
  EXPECT_THAT(html, HasSubstr("<h2>Heading of Diagnosis of slide</h2>"));
  EXPECT_THAT(html, Not(HasSubstr("<section")));
}

TEST_F(RunFolder, HoldsTheClipWithItsCaptionAndCommand) {
  Write("diagnosis", Judged("x", Tone::kBad));
  folder_.Write("clip.mp4", Mp4("avc1"));
  folder_.Write("render.json",
                R"({"setup": "slide", "faults": [{"name": "zeta", "value": 1.2}],
                    "effects": [{"effect": "backlash", "site": "X"}],
                    "speed": 0.01, "amplification": {"u3": 5000, "X": 1, "Y": 20, "r1": 5000},
                    "command": "mjdiag render y"})");
  const std::string html = Html();
  EXPECT_THAT(html, HasSubstr("src=\"data:video/mp4;base64,AAAADGZ0eXBpc29t"));
  EXPECT_THAT(
      html,
      HasSubstr(
          "slide, healthy and with zeta = 1.2, backlash at X; 100 times slower than "
          "real; amplified 5000 times: r1, u3; 20 times: Y."));
  EXPECT_THAT(html, HasSubstr("mjdiag x\nmjdiag render y"));
}

TEST_F(RunFolder, SaysWhereAClipIsThatBrowsersDoNotPlay) {
  Write("diagnosis", Judged("x", Tone::kBad));
  folder_.Write("clip.mp4", Mp4("mp4v"));
  const std::string html = Html();
  EXPECT_THAT(html, HasSubstr("coded as mp4v, which browsers do not play"));
  EXPECT_THAT(html, Not(HasSubstr("<video")));
}

TEST_F(RunFolder, RefusesWhatIsMissingOrBroken) {
  EXPECT_THAT(Refused(),
              AllOf(HasSubstr("nothing to report"), HasSubstr(".page.json")));
  EXPECT_THAT(
      test::MessageOf<InputError>([&] { WriteReport(folder_.path() / "none"); }),
      HasSubstr("no such folder"));
  Write("diagnosis", Judged("x", Tone::kBad));
  const std::string whole = Mp4("avc1");
  for (const std::size_t part : {0UL, 4UL, 12UL, 15UL, whole.size() - 1}) {
    folder_.Write("clip.mp4", whole.substr(0, part));
    EXPECT_THAT(Refused(), HasSubstr("clip.mp4")) << part;
  }
  folder_.Write("clip.mp4", whole);
  folder_.Write("render.json", "{\"speed\":");
  EXPECT_THAT(Refused(), HasSubstr("render.json"));
  fs::remove(folder_.path() / "render.json");
  folder_.Write("broken.page.json", "{");
  EXPECT_THAT(Refused(), HasSubstr("broken.page.json"));
}

TEST_F(RunFolder, KeepsTheOldReportWhenANewOneCannotBeMade) {
  Write("diagnosis", Judged("x", Tone::kBad));
  const std::string old = Html();
  folder_.Write("broken.page.json", "{");
  EXPECT_THROW(WriteReport(folder_.path()), InputError);
  EXPECT_EQ(ReadTextFile(folder_.path() / "report.html"), old);
}

}  // namespace
}  // namespace mjdiag
