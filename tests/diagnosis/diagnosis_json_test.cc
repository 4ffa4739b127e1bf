#include "mjdiag/diagnosis/diagnosis_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

TEST(DiagnosisJson, HasTheFieldsThatOtherProgramsRead) {
  DiagnosisResult result;
  result.setup = "stage";
  result.samples = 100;
  result.first_detection = 0.25;
  result.faults = {{"damping", 1.25, 0.25, 0.125, {1.0, 1.5}, true}};
  result.disturbance.tones.emplace_back();
  const auto document = nlohmann::json::parse(DiagnosisJson(result));
  EXPECT_EQ(document["schema"], "mjdiag.diagnosis/1");
  EXPECT_EQ(document["setup"], "stage");
  EXPECT_EQ(document["samples"], 100);
  EXPECT_EQ(document["first_detection"], 0.25);
  EXPECT_TRUE(document["lasting_since"].is_null());
  for (const char* key : {"sample_time", "detected", "residual", "disturbance"}) {
    EXPECT_TRUE(document.contains(key)) << key;
  }
  for (const char* key : {"min", "max", "threshold_min", "threshold_max"}) {
    EXPECT_TRUE(document["residual"].contains(key)) << key;
  }
  const nlohmann::json expected = {
      {"name", "damping"},  {"value", 1.25},
      {"deviation", 0.25},  {"sd", 0.125},
      {"ci95", {1.0, 1.5}}, {"detected", true},
      {"alarm", nullptr},   {"alarm_with_more_records", nullptr}};
  EXPECT_EQ(document["faults"][0], expected);
  for (const char* key : {"peaks", "total", "total_threshold"}) {
    EXPECT_TRUE(document["disturbance"].contains(key)) << key;
  }
  EXPECT_TRUE(document["disturbance"]["peaks"][0].contains("frequency"));
}

}  // namespace
}  // namespace mjdiag
