#include "mjdiag/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kHostile = "<script>alert('a & \"b\"')</script>";
constexpr const char* kHarmless =
    "&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;";

TimePlot Ramp(Eigen::Index samples) {
  TimePlot plot;
  plot.caption = "x";
  plot.quantity = "x";
  plot.unit = "m";
  plot.sample_time = 1e-3;
  plot.curves = {{"measured", CurveRole::kMeasured,
                  Eigen::VectorXd::LinSpaced(samples, 0.0, 1.0)}};
  return plot;
}

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos;
       at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

TEST(Report, EscapesAllText) {
  Page page(kHostile);
  page.SetVerdict(Tone::kBad, kHostile);
  page.AddHeading(kHostile);
  page.AddParagraph(kHostile);
  page.AddFacts({{kHostile, kHostile}});
  page.AddTable({{{kHostile}}, {{kHostile}}});
  page.AddCode(kHostile);
  page.SetRun({kHostile, "", {{kHostile, kHostile}}});
  const std::string html = ReportHtml(page);
  EXPECT_THAT(html, Not(HasSubstr("alert('")));
  // The title stands twice: in the head and as the heading.
  EXPECT_EQ(Count(html, kHarmless), 13);
}

TEST(Report, DataOfAPlotCannotEndItsElement) {
  Page page("x");
  TimePlot plot = Ramp(3);
  plot.caption = plot.quantity = plot.curves[0].label = kHostile;
  page.AddPlot(plot);
  const std::string html = ReportHtml(page);
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, HasSubstr("\\u003cscript>alert"));
}

TEST(Report, NeedsNoNetwork) {
  Page page("x");
  page.AddPlot(Ramp(3));
  const std::string html = ReportHtml(page);
  const std::regex loads(R"((src|href|srcset|action)\s*=\s*["']?\s*(https?:)?//)");
  EXPECT_FALSE(std::regex_search(html, loads));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("sourceMappingURL")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

TEST(Report, CarriesThePlotLibraryOnlyIfItHasPlots) {
  Page page("x");
  EXPECT_THAT(ReportHtml(page), Not(HasSubstr("<script")));
  page.AddPlot(Ramp(3));
  page.AddPlot(Ramp(3));
  const std::string html = ReportHtml(page);
  EXPECT_THAT(html, HasSubstr("Dygraph"));
  EXPECT_EQ(Count(html, "<figure"), 2);
  EXPECT_EQ(Count(html, "id=\"reset-zoom\""), 1);
}

TEST(Report, HoldsEveryKindOfPlotInItsPlace) {
  Page page("x");
  page.AddPlot(XyPlot{"force over velocity", "v", "m/s", "F", "N", {}, {}, 321});
  HistogramPlot histogram;
  histogram.caption = "residual";
  histogram.edges = Eigen::Vector2d(0.0, 1.0);
  histogram.counts = Eigen::VectorXd::Ones(1);
  page.AddPlot(histogram);
  BodePlot bode;
  bode.caption = "low-pass";
  page.AddPlot(bode);
  const std::string html = ReportHtml(page);
  EXPECT_THAT(html, HasSubstr("<figcaption>force over velocity</figcaption>"));
  EXPECT_THAT(html, HasSubstr("height:321px"));
  const auto xy = html.find(R"("kind":"xy")");
  const auto bars = html.find(R"("kind":"histogram")");
  const auto magnitude = html.find(R"("kind":"bode")");
  EXPECT_LT(xy, bars);
  EXPECT_LT(bars, magnitude);
  EXPECT_NE(magnitude, std::string::npos);
}

TEST(Report, AlignsNumbersOfATable) {
  Page page("x");
  page.AddTable({{{"name"}, {"rms", true}}, {{"q", "1"}}});
  EXPECT_THAT(ReportHtml(page),
              HasSubstr("<td>q</td><td class=\"number\">1</td></tr>"));
}

TEST(Report, FollowsTheSchemeOfTheReader) {
  const std::string html = ReportHtml(Page("x"));
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(html, HasSubstr("@media print"));
  EXPECT_THAT(html, HasSubstr("width=device-width"));
}

TEST(Report, OfTwelveChannelsStaysSmall) {
  Page page("x");
  TimePlot two = Ramp(20000);
  two.curves.push_back(two.curves[0]);
  for (int channel = 0; channel < 12; ++channel) {
    page.AddPlot(two);
    page.AddPlot(Ramp(20000));
  }
  EXPECT_LT(ReportHtml(page).size(), 5'000'000U);
}

}  // namespace
}  // namespace mjdiag
