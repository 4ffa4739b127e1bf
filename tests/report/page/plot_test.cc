#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mjdiag/report/page/plot_json.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

/// How a page holds these samples.
nlohmann::json Floats(const std::vector<float>& values) {
  TimePlot plot;
  plot.unit = "1";
  plot.curves = {{"", CurveRole::kMeasured, Eigen::VectorXd(values.size())}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    plot.curves[0].values[static_cast<Eigen::Index>(i)] = values[i];
  }
  return DescribePlot(plot)["curves"][0]["samples"];
}

TEST(Plot, EmbedsSamplesAsBase64OfFloats) {
  TimePlot plot;
  plot.quantity = "x";
  plot.unit = "N";
  plot.start_time = 0.5;
  plot.sample_time = 0.25;
  plot.curves = {{"measured", CurveRole::kMeasured, Eigen::Vector2d(1.0, -2.0)}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["curves"][0]["samples"], "AACAPwAAAMA=");
  EXPECT_EQ(json["start"], 0.5);
  EXPECT_EQ(json["step"], 0.25);
}

TEST(Plot, ChoosesThePrefixThatSuitsTheData) {
  TimePlot plot;
  plot.quantity = "x";
  plot.unit = "m";
  plot.curves = {{"mismatch", CurveRole::kMismatch, Eigen::Vector2d(2e-6, -4e-6)}};
  plot.levels = {{1e-6, "noise floor"}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["y_label"], "x [µm]");
  EXPECT_NEAR(json["levels"][0]["value"].get<double>(), 1.0, 1e-12);
}

TEST(Plot, NamesTheUnitOfAnAmplitudeDensity) {
  SpectrumPlot plot;
  plot.quantity = "x";
  plot.unit = "m";
  plot.frequency = Eigen::Vector2d(1.0, 2.0);
  plot.curves = {{"mismatch", CurveRole::kMismatch, Eigen::Vector2d(2e-9, 1e-9)}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["kind"], "spectrum");
  EXPECT_EQ(json["y_label"], "x [nm/√Hz]");
}

TEST(Plot, ShadesItsBands) {
  TimePlot plot;
  plot.curves = {{"measured", CurveRole::kMeasured, Eigen::Vector2d(0.0, 0.0)}};
  plot.bands = {{1.0, 1.5, "worst window"}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["bands"][0]["from"], 1.0);
  EXPECT_EQ(json["bands"][0]["to"], 1.5);
  EXPECT_EQ(json["bands"][0]["label"], "worst window");
}

TEST(Plot, GivesBothAxesOfAnXyPlotTheUnitThatSuitsThem) {
  XyPlot plot;
  plot.x_quantity = "velocity";
  plot.x_unit = "m/s";
  plot.y_quantity = "force";
  plot.y_unit = "N";
  // The law reaches further than the points: it counts for the unit, too.
  plot.points = {{"unexplained", CurveRole::kMismatch, Eigen::Vector2d(-0.001, 0.001),
                  Eigen::Vector2d(-20.0, 20.0)}};
  plot.curves = {{"law", CurveRole::kSimulated, Eigen::Vector3d(-0.002, 0.0, 0.002),
                  Eigen::Vector3d(-2000.0, 0.0, 2000.0)}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["kind"], "xy");
  EXPECT_EQ(json["x_label"], "velocity [mm/s]");
  EXPECT_EQ(json["y_label"], "force [kN]");
  EXPECT_EQ(json["points"][0]["x"], Floats({-1.0F, 1.0F}));
  EXPECT_EQ(json["points"][0]["y"], Floats({-0.02F, 0.02F}));
  EXPECT_EQ(json["points"][0]["role"], "mismatch");
  EXPECT_EQ(json["curves"][0]["x"], Floats({-2.0F, 0.0F, 2.0F}));
  EXPECT_EQ(json["curves"][0]["y"], Floats({-2.0F, 0.0F, 2.0F}));
}

TEST(Plot, RefusesPointsWithoutAPartner) {
  XyPlot plot;
  plot.caption = "force";
  plot.points = {{"unexplained", CurveRole::kMismatch, Eigen::Vector2d(0.0, 1.0),
                  Eigen::Vector3d(0.0, 1.0, 2.0)}};
  EXPECT_THAT(test::MessageOf<InputError>([&] { DescribePlot(plot); }),
              testing::AllOf(testing::HasSubstr("'force'"),
                             testing::HasSubstr("'unexplained'")));
}

TEST(Plot, ShowsAHistogramInTheUnitOfItsQuantity) {
  HistogramPlot plot;
  plot.quantity = "residual";
  plot.unit = "m";
  plot.counted = "samples";
  plot.edges = Eigen::Vector3d(-1e-6, 0.0, 1e-6);
  plot.counts = Eigen::Vector2d(5.0, 7.0);
  plot.curves = {{"normal", CurveRole::kMismatch, Eigen::Vector2d(-1e-6, 1e-6),
                  Eigen::Vector2d(6.0, 6.0)}};
  plot.marks = {{2e-6, "threshold"}};
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["x_label"], "residual [µm]");
  EXPECT_EQ(json["bars"]["edges"], Floats({-1.0F, 0.0F, 1.0F}));
  EXPECT_EQ(json["bars"]["counts"], Floats({5.0F, 7.0F}));
  // Counts have no unit that a prefix could change.
  EXPECT_EQ(json["curves"][0]["y"], Floats({6.0F, 6.0F}));
  EXPECT_NEAR(json["marks"][0]["value"].get<double>(), 2.0, 1e-12);
  plot.counts = Eigen::Vector3d(5.0, 7.0, 1.0);
  EXPECT_THROW(DescribePlot(plot), InputError);
}

TEST(Plot, ShowsABodeMagnitudeInDecibels) {
  BodePlot plot;
  plot.quantity = "gain";
  plot.unit = "1/N";
  plot.frequency = Eigen::Vector2d(1.0, 10.0);
  plot.curves.assign(7, {"low-pass", Eigen::Vector2d(1.0, 0.01)});
  const auto json = DescribePlot(plot);
  EXPECT_EQ(json["y_label"], "gain [dB re 1/N]");
  EXPECT_EQ(json["curves"][0]["samples"], Floats({0.0F, -40.0F}));
  // Neighbours differ in colour; the seventh begins again.
  EXPECT_EQ(json["curves"][0]["role"], "palette0");
  EXPECT_EQ(json["curves"][1]["role"], "palette1");
  EXPECT_EQ(json["curves"][6]["role"], "palette0");
  plot.frequency = Eigen::Vector3d(1.0, 10.0, 100.0);
  EXPECT_THROW(DescribePlot(plot), InputError);
}

}  // namespace
}  // namespace mjdiag
