#include "mjdiag/report/comparison_json.h"

#include <gtest/gtest.h>

#include <limits>

#include "report/sample_comparison.h"

namespace mjdiag {
namespace {

TEST(ComparisonJson, HasTheFieldsThatOtherProgramsRead) {
  const Comparison comparison = SampleComparison();
  const nlohmann::json json = ToJson(comparison);
  const nlohmann::json& q = json.at("channels").at("q");
  EXPECT_EQ(q.at("rms"), comparison.channels[0].rms);
  EXPECT_EQ(q.at("unit"), "m");
  EXPECT_EQ(q.at("relative_error_percent"),
            comparison.channels[0].relative_error_percent);
  EXPECT_EQ(q.at("noise_floor"), 2e-8);
  EXPECT_EQ(q.at("exceeds_noise"), true);
  EXPECT_EQ(json.at("channels").at("u").at("exceeds_noise"), false);
  EXPECT_EQ(json.at("derived").at("q_velocity"), 0.25);
  EXPECT_EQ(json.at("derived").at("force"), 4.5);
}

TEST(ComparisonJson, HasWhereAndHowTheFiguresCameAbout) {
  const nlohmann::json json = ToJson(SampleComparison());
  EXPECT_EQ(json.at("schema"), "mjdiag.compare/1");
  EXPECT_EQ(json.at("samples"), 1000);
  EXPECT_EQ(json.at("skip_samples"), 10);
  EXPECT_EQ(json.at("level"), 0.01);
  EXPECT_EQ(json.at("exceeds_noise"), true);
  EXPECT_EQ(json.at("not_measured"), nlohmann::json({"w"}));
  const nlohmann::json& worst = json.at("channels").at("q").at("worst_window");
  EXPECT_GE(worst.at("start"), 0.5);
  EXPECT_NEAR(worst.at("rms").get<double>(), 3e-6, 1e-12);
}

TEST(ComparisonJson, WritesNullForAnErrorWithoutAValue) {
  Comparison comparison = SampleComparison();
  comparison.derived[0].relative_error_percent =
      std::numeric_limits<double>::infinity();
  EXPECT_TRUE(ToJson(comparison).at("derived").at("q_velocity").is_null());
}

}  // namespace
}  // namespace mjdiag
