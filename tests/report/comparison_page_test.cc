#include "mjdiag/report/comparison_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/report/report.h"
#include "report/sample_comparison.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::Not;

const RunDescription kRun = {
    "mjdiag compare --setup 'a <b>'", "record.csv", {{"mjdiag", "0.1.0"}}};

TEST(ComparisonVerdict, NamesTheChannelAndHowFarItIsAboveTheNoise) {
  const std::string verdict = ComparisonVerdict(SampleComparison());
  // 3 um over half of the samples are 2.13 um rms.
  EXPECT_THAT(verdict, HasSubstr("mismatch of q is 107 times its noise floor"));
  EXPECT_THAT(verdict, HasSubstr("2.13 µm rms"));
}

TEST(ComparisonVerdict, SaysSoIfThereIsNothing) {
  Comparison comparison = SampleComparison();
  comparison.channels.erase(comparison.channels.begin());
  EXPECT_EQ(ComparisonVerdict(comparison), "No mismatch beyond the noise floor in u.");
}

TEST(ComparisonPage, BeginsWithTheVerdict) {
  const std::string html = ReportHtml(ComparisonPage(SampleComparison(), kRun));
  const auto verdict = html.find("class=\"verdict bad\"");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, html.find("<dl>"));
  EXPECT_LT(verdict, html.find("<table>"));
}

TEST(ComparisonPage, ShowsSignalMismatchAndSpectrumOfEveryChannel) {
  const std::string html = ReportHtml(ComparisonPage(SampleComparison(), kRun));
  for (const char* caption :
       {"q, measured and simulated", "q, mismatch", "q, spectrum of the mismatch",
        "u, measured and simulated", "u, mismatch", "u, spectrum of the mismatch"}) {
    EXPECT_THAT(html, HasSubstr("<figcaption>" + std::string(caption)));
  }
  EXPECT_THAT(html, HasSubstr(R"("label":"worst window")"));
}

TEST(ComparisonPage, SaysHowToDoItAgain) {
  const std::string html = ReportHtml(ComparisonPage(SampleComparison(), kRun));
  EXPECT_THAT(html, HasSubstr("<code>mjdiag compare --setup &#39;a &lt;b&gt;&#39;"));
  EXPECT_THAT(html, HasSubstr("<dt>mjdiag</dt>\n<dd>0.1.0</dd>"));
  EXPECT_THAT(html, HasSubstr("<dd>record.csv</dd>"));
  EXPECT_THAT(html, HasSubstr("stage &lt;1&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("stage <1>")));
}

TEST(ComparisonPage, ListsWhatWasNotMeasured) {
  const std::string html = ReportHtml(ComparisonPage(SampleComparison(), kRun));
  EXPECT_THAT(html, HasSubstr("<dt>Not measured</dt>\n<dd>w</dd>"));
}

}  // namespace
}  // namespace mjdiag
