#include "mjdiag/report/page/page_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mjdiag/report/page/page_document.h"
#include "mjdiag/report/report.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Page WholePage() {
  Page page("Slide");
  page.SetVerdict(Tone::kBad, "Worn.");
  page.SetRun({"mjdiag x", "r.csv", {{"mjdiag", "1"}}});
  page.AddHeading("Causes");
  page.AddParagraph("text");
  page.AddFacts({{"Setup", "slide"}});
  page.AddTable({{{"a"}, {"b", true}}, {{"1", "2"}}});
  page.AddCode("code");
  TimePlot plot;
  plot.caption = "q";
  plot.sample_time = 1e-3;
  plot.curves = {{"q", CurveRole::kMeasured, Eigen::Vector3d(0.0, 1.0, 2.0)}};
  page.AddPlot(plot);
  return page;
}

class PageFile : public ::testing::Test {
 protected:
  /// What is said of this file.
  std::string Refused(const std::string& text) {
    const std::filesystem::path file = folder_.Write("x.page.json", text);
    return test::MessageOf<InputError>([&] { ReadPageDocument(file); });
  }
  std::string Refused(const json& document) { return Refused(document.dump()); }
  const test::TemporaryFolder folder_;
};

TEST_F(PageFile, GivesBackWhatWasWritten) {
  WritePage(folder_.path(), "slide", WholePage());
  EXPECT_EQ(ReadPageDocument(folder_.path() / "slide.page.json"),
            WholePage().document().json);
}

TEST_F(PageFile, LeavesNothingBesideIt) {
  WritePage(folder_.path(), "slide", WholePage());
  WritePage(folder_.path(), "slide", WholePage());
  const std::filesystem::directory_iterator files(folder_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST_F(PageFile, SaysThatAFileIsBrokenOff) {
  const std::string whole = WholePage().document().json.dump();
  for (const std::size_t part : {1UL, whole.size() / 2, whole.size() - 1}) {
    EXPECT_THAT(Refused(whole.substr(0, part)),
                AllOf(HasSubstr("x.page.json"), HasSubstr("broken off")));
  }
  EXPECT_THAT(Refused(std::string()), HasSubstr("empty"));
  EXPECT_THAT(Refused(std::string("\xff\xfe binary")), HasSubstr("damaged"));
}

TEST_F(PageFile, NamesThePartThatIsNotRight) {
  const json whole = WholePage().document().json;
  json other = whole;
  other["schema"] = "mjdiag.page/2";
  EXPECT_THAT(Refused(other), HasSubstr("'schema'"));
  EXPECT_THAT(Refused(json(3)), HasSubstr("not a page"));
  for (const auto& [key, value] : whole.items()) {
    json cut = whole;
    cut.erase(key);
    EXPECT_THAT(Refused(cut), HasSubstr("'" + key + "'"));
  }
  for (std::size_t i = 0; i < whole["blocks"].size(); ++i) {
    for (const auto& [key, value] : whole["blocks"][i].items()) {
      json wrong = whole;
      wrong["blocks"][i][key] = 7;
      EXPECT_THAT(Refused(wrong), HasSubstr("blocks[" + std::to_string(i) + "]"))
          << key;
    }
  }
  other = whole;
  other["verdict"]["tone"] = "red\" onload=\"";
  EXPECT_THAT(Refused(other), HasSubstr("verdict.tone"));
}

TEST_F(PageFile, NamesSamplesThatAPageCouldNotDraw) {
  const json whole = WholePage().document().json;
  const std::size_t last = whole["blocks"].size() - 1;
  for (const json& samples : {json("AAAA"), json("AAA"), json("<b>="), json(1.0)}) {
    json wrong = whole;
    wrong["blocks"][last]["plot"]["curves"][0]["samples"] = samples;
    EXPECT_THAT(Refused(wrong), HasSubstr("samples")) << samples;
  }
}

}  // namespace
}  // namespace mjdiag
