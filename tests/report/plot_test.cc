#include "mjdiag/report/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

TEST(Plot, EmbedsSamplesAsBase64OfFloats) {
  TimePlot plot;
  plot.quantity = "x";
  plot.unit = "N";
  plot.start_time = 0.5;
  plot.sample_time = 0.25;
  plot.curves = {{"measured", CurveRole::kMeasured, Eigen::Vector2d(1.0, -2.0)}};
  const auto json = nlohmann::json::parse(DescribePlot(plot));
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
  const auto json = nlohmann::json::parse(DescribePlot(plot));
  EXPECT_EQ(json["y_label"], "x [µm]");
  EXPECT_NEAR(json["levels"][0]["value"].get<double>(), 1.0, 1e-12);
}

TEST(Plot, NamesTheUnitOfAnAmplitudeDensity) {
  SpectrumPlot plot;
  plot.quantity = "x";
  plot.unit = "m";
  plot.frequency = Eigen::Vector2d(1.0, 2.0);
  plot.curves = {{"mismatch", CurveRole::kMismatch, Eigen::Vector2d(2e-9, 1e-9)}};
  const auto json = nlohmann::json::parse(DescribePlot(plot));
  EXPECT_EQ(json["kind"], "spectrum");
  EXPECT_EQ(json["y_label"], "x [nm/√Hz]");
}

TEST(Plot, ShadesItsBands) {
  TimePlot plot;
  plot.curves = {{"measured", CurveRole::kMeasured, Eigen::Vector2d(0.0, 0.0)}};
  plot.bands = {{1.0, 1.5, "worst window"}};
  const auto json = nlohmann::json::parse(DescribePlot(plot));
  EXPECT_EQ(json["bands"][0]["from"], 1.0);
  EXPECT_EQ(json["bands"][0]["to"], 1.5);
  EXPECT_EQ(json["bands"][0]["label"], "worst window");
}

}  // namespace
}  // namespace mjdiag
