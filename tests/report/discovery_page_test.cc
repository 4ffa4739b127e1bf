#include "mjdiag/report/discovery_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/report/discovery_plots.h"
#include "mjdiag/report/report.h"
#include "report/sample_discovery.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;
using testing::Not;

const DiscoveryRun kRun = {
    {"mjdiag discover --setup 'a <b>'", "record.csv", {{"mjdiag", "0.1.0"}}},
    "pulses.csv",
    "out/extended/plant.xml"};

std::string Caption(const std::string& text) { return "<figcaption>" + text; }

TEST(DiscoveryPage, BeginsWithTheVerdictThenTheCauses) {
  const std::string html = ReportHtml(DiscoveryPage(SampleDiscovery(), kRun));
  const auto verdict = html.find("class=\"verdict good\"");
  const auto causes = html.find("<h2>Causes");
  ASSERT_NE(verdict, std::string::npos);
  ASSERT_NE(causes, std::string::npos);
  EXPECT_LT(verdict, html.find("<dl>"));
  EXPECT_LT(verdict, causes);
  EXPECT_LT(causes, html.find("<h2>After each cause"));
  EXPECT_LT(causes, html.find("<figure"));
}

TEST(DiscoveryPage, ShowsMismatchForceAndLaw) {
  const std::string html = ReportHtml(DiscoveryPage(SampleDiscovery(), kRun));
  for (const char* caption :
       {"q, measured - simulated", "Unexplained at load, plant as given",
        "Unexplained at load, extended plant",
        "coulomb_friction at load, over velocity of load"}) {
    EXPECT_THAT(html, HasSubstr(Caption(caption)));
  }
  EXPECT_THAT(html, HasSubstr("<h2>What it is for: how small a fault is seen"));
  EXPECT_THAT(html, HasSubstr("backlash at load cannot be judged"));
}

TEST(DiscoveryPage, SaysHowToDoItAgain) {
  const std::string html = ReportHtml(DiscoveryPage(SampleDiscovery(), kRun));
  EXPECT_THAT(html, HasSubstr("<code>mjdiag discover --setup &#39;a &lt;b&gt;&#39;"));
  EXPECT_THAT(html, HasSubstr("<dd>record.csv</dd>"));
  EXPECT_THAT(html, HasSubstr("<dd>pulses.csv</dd>"));
  EXPECT_THAT(html, HasSubstr("<dd>out/extended/plant.xml</dd>"));
  EXPECT_THAT(html, Not(HasSubstr("slide <1>")));
}

TEST(DiscoveryPage, ShowsWhatTheRestDependsOnThatNoCauseExplains) {
  const std::string html = ReportHtml(DiscoveryPage(SampleUnexplained(), kRun));
  EXPECT_THAT(html, HasSubstr("class=\"verdict bad\""));
  EXPECT_THAT(html, HasSubstr(Caption("What is left at load, over position of load")));
  EXPECT_THAT(html, HasSubstr("<dd>fourth power</dd>"));
  EXPECT_THAT(html, Not(HasSubstr("<h2>Causes")));
  EXPECT_THAT(html, Not(HasSubstr("extended plant</figcaption>")));
}

TEST(DiscoveryPage, HoldsADiscoveryWithoutFigures) {
  Discovery discovery;
  discovery.setup = "empty";
  const std::string html = ReportHtml(DiscoveryPage(discovery, kRun));
  EXPECT_THAT(html, HasSubstr("noise explains the mismatch"));
  EXPECT_THAT(html, Not(HasSubstr("<figure")));
  EXPECT_THAT(html, Not(HasSubstr("<dt>Length")));
  EXPECT_THAT(html, Not(HasSubstr("<dt>Fitted to")));
}

TEST(MismatchPlots, ShowTheWorstChannelsFirst) {
  Comparison comparison = SampleReplay(5e-6);
  comparison.measured.Add({"w", "m", SampleSine(1.0)});
  comparison.simulated.Add({"w", "m", SampleSine(2.0)});
  comparison.channels.push_back(MeasureMismatch(
      comparison.measured, comparison.simulated, "w", {1e-7, 2000, 2000}, {}));
  const auto plots = MismatchPlots(comparison, nullptr, 0.7, 1);
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].quantity, "w");
}

TEST(MismatchPlots, ShadeWhatWasNotFittedAndLeaveOutWhatDoesNotCount) {
  const Comparison before = SampleReplay(5e-6);
  const Comparison after = SampleReplay(1e-7);
  const TimePlot plot = MismatchPlots(before, &after, 0.7, 3).at(0);
  ASSERT_EQ(plot.curves.size(), 2u);
  EXPECT_TRUE(std::isnan(plot.curves[0].values[9]));
  EXPECT_NEAR(plot.curves[0].values[125], 5e-6, 1e-12);
  EXPECT_NEAR(plot.curves[1].values[125], 1e-7, 1e-12);
  ASSERT_EQ(plot.bands.size(), 1u);
  EXPECT_DOUBLE_EQ(plot.bands[0].from, 1.4);
  EXPECT_DOUBLE_EQ(plot.bands[0].to, 2.0);
  EXPECT_TRUE(MismatchPlots(before, &after, 0.0, 3).at(0).bands.empty());
}

TEST(UnexplainedPlots, ShowTheForceAndTheLimitsOfItsError) {
  const auto plots = UnexplainedPlots(SampleDiscovery());
  ASSERT_EQ(plots.size(), 2u);
  const Eigen::VectorXd& value = plots[0].curves.at(0).values;
  EXPECT_NEAR(value[125], 20.0, 1e-9);
  EXPECT_DOUBLE_EQ(plots[0].levels.at(0).value, 1.6);
}

TEST(UnexplainedPlots, ShowTheLimitsOfASignalThatStaysWithin) {
  const TimePlot after = UnexplainedPlots(SampleDiscovery()).at(1);
  EXPECT_TRUE(after.levels.empty());
  ASSERT_EQ(after.curves.size(), 3u);
  EXPECT_DOUBLE_EQ(after.curves[1].values[0], 0.8);
  EXPECT_DOUBLE_EQ(after.curves[2].values[0], -0.8);
}

TEST(LawPlots, KeepAPageLight) {
  LawPlot law = SampleLaw();
  law.x = Eigen::VectorXd::LinSpaced(20001, 0.0, 20000.0);
  law.y = law.x;
  const XyPlot plot = PlotOf(law);
  EXPECT_LE(plot.points.at(0).x.size(), 5000);
  EXPECT_EQ(plot.points.at(0).x[1], plot.points.at(0).y[1]);
  EXPECT_GE(plot.points.at(0).x.tail<1>()[0], 19990.0);
}

TEST(ResidualDependencePlot, ShowsTheCurveBetweenTwoStandardDeviations) {
  const XyPlot plot = ResidualDependencePlot(*SampleUnexplained().unexplained, "N");
  EXPECT_EQ(plot.y_unit, "N");
  ASSERT_EQ(plot.curves.size(), 3u);
  EXPECT_NEAR(plot.curves[1].y[0] - plot.curves[0].y[0], 1.0, 1e-12);
  EXPECT_NEAR(plot.curves[2].y[0] - plot.curves[0].y[0], -1.0, 1e-12);
}

}  // namespace
}  // namespace mjdiag
