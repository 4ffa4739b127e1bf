#include "mjdiag/report/discovery_json.h"

#include <gtest/gtest.h>

#include <limits>

#include "report/sample_discovery.h"

namespace mjdiag {
namespace {

using nlohmann::json;

TEST(DiscoveryJson, HasTheFieldsOfTheDesign) {
  const json document = ToJson(SampleDiscovery(), "out/extended/plant.xml");
  EXPECT_EQ(document.at("schema"), "mjdiag.discovery/1");
  EXPECT_EQ(document.at("verdict"), "explained");
  const json& friction = document.at("causes").at(0);
  EXPECT_EQ(friction.at("effect"), "coulomb_friction");
  EXPECT_EQ(friction.at("site"), "load");
  EXPECT_EQ(friction.at("probability"), 0.963);
  const json& force = friction.at("parameters").at("force");
  EXPECT_EQ(force.at("value"), 20.39);
  EXPECT_EQ(force.at("unit"), "N");
  EXPECT_EQ(force.at("ci95"), json({20.206, 20.574}));
  const json& alternative = friction.at("alternatives").at(0);
  EXPECT_EQ(alternative.at("effect"), "stribeck_friction");
  EXPECT_EQ(alternative.at("site"), "load");
  EXPECT_EQ(alternative.at("probability"), 0.031);
  EXPECT_EQ(document.at("mismatch").at("before").at("train").at("q"), 3.5e-6);
  EXPECT_EQ(document.at("mismatch").at("before").at("validation").at("q"), 4e-6);
  EXPECT_EQ(document.at("mismatch").at("after").at("train").at("q"), 1e-7);
  EXPECT_EQ(document.at("mismatch").at("after").at("validation").at("q"), 1.1e-7);
  EXPECT_EQ(document.at("noise_floor").at("q"), 1e-7);
  EXPECT_EQ(document.at("gain").at("train"), 0.971);
  EXPECT_EQ(document.at("gain").at("validation"), 0.9725);
  EXPECT_EQ(document.at("extended_plant"), "out/extended/plant.xml");
  EXPECT_TRUE(document.at("unexplained").at("signature").is_null());
}

TEST(DiscoveryJson, GivesAFaultByItsNameAndValue) {
  const json fault = ToJson(SampleDiscovery(), "").at("causes").at(1);
  EXPECT_EQ(fault.at("effect"), "eta");
  EXPECT_EQ(fault.at("site"), "drive");
  EXPECT_EQ(fault.at("fault"), true);
  EXPECT_EQ(fault.at("parameters").at("value").at("value"), 1.0342);
  EXPECT_EQ(fault.at("alternatives").at(0).at("indistinguishable"), true);
}

TEST(DiscoveryJson, SaysTheKindOfPhysicsAndWhere) {
  const json kind = ToJson(SampleDiscovery(), "").at("kinds").at(0);
  EXPECT_EQ(kind.at("kind"), "dry friction");
  EXPECT_EQ(kind.at("site"), "load");
  EXPECT_EQ(kind.at("probability"), 0.998);
  EXPECT_EQ(kind.at("share"), 0.62);
  EXPECT_EQ(kind.at("words"),
            "dry friction at load, a resistance that does not grow with speed: all but "
            "certain");
}

TEST(DiscoveryJson, GivesAllExplanationsTheLikeliestFirst) {
  const json explanations = ToJson(SampleDiscovery(), "").at("explanations");
  // Friction or its runner-up, the motor by either of its names.
  ASSERT_EQ(explanations.size(), 3u);
  double sum = 0.0;
  for (const json& one : explanations) sum += one.at("probability").get<double>();
  EXPECT_NEAR(sum, 1.0, 0.01);
  EXPECT_EQ(explanations[0]["causes"], json::parse(R"([
              {"effect": "coulomb_friction", "site": "load", "fault": false},
              {"effect": "eta", "site": "drive", "fault": true}])"));
  EXPECT_EQ(explanations[1]["causes"][1]["effect"], "motor_constant");
  EXPECT_EQ(explanations[2]["causes"][0]["effect"], "stribeck_friction");
  EXPECT_EQ(ToJson(Discovery(), "").at("explanations"), json::array());
}

TEST(DiscoveryJson, HasNoPlantWithoutAPath) {
  EXPECT_TRUE(ToJson(SampleDiscovery(), "").at("extended_plant").is_null());
}

TEST(DiscoveryJson, HasTheLadderTheLimitsAndTheNotes) {
  const json document = ToJson(SampleDiscovery(), "");
  const json& step = document.at("ladder").at(1);
  EXPECT_EQ(step.at("added"), "coulomb_friction@load");
  EXPECT_EQ(step.at("train"), 1.2);
  EXPECT_EQ(step.at("held_out"), 1.3);
  EXPECT_EQ(step.at("error_percent").at("force"), 4.6);
  EXPECT_EQ(step.at("validation_percent").at("force"), 6.0);
  EXPECT_EQ(document.at("fault_limits").at(0).at("fault"), "zeta");
  EXPECT_EQ(document.at("fault_limits").at(0).at("before"), 0.2);
  EXPECT_EQ(document.at("fault_limits").at(0).at("after"), 0.01);
  EXPECT_EQ(document.at("notes").size(), 1u);
  EXPECT_DOUBLE_EQ(document.at("whiteness").at("before"), 0.2);
  EXPECT_DOUBLE_EQ(document.at("whiteness").at("after"), 0.99);
  EXPECT_EQ(document.at("train_share"), 0.7);
  const json& derived = document.at("derived");
  EXPECT_EQ(derived.at("before").at("record").at("force"), 5.0);
  EXPECT_TRUE(derived.at("before").at("validation").is_null());
}

TEST(DiscoveryJson, SaysWhatTheRestDependsOn) {
  const json document = ToJson(SampleUnexplained(), "");
  EXPECT_EQ(document.at("verdict"), "unexplained");
  EXPECT_EQ(document.at("causes"), json::array());
  const json& unexplained = document.at("unexplained");
  EXPECT_EQ(unexplained.at("signature"),
            "The force that is left at load is a fourth power of its position.");
  EXPECT_EQ(unexplained.at("variable"), "position of load");
  EXPECT_EQ(unexplained.at("shape"), "fourth power");
  EXPECT_TRUE(unexplained.at("factor").is_null());
}

TEST(DiscoveryJson, WritesNullForWhatIsNotFinite) {
  Discovery discovery = SampleDiscovery();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  discovery.causes[0].parameters[0].high = std::numeric_limits<double>::infinity();
  discovery.mismatch_after.train["q"] = nan;
  discovery.gain_train = nan;
  const json document = ToJson(discovery, "");
  const json& force = document.at("causes").at(0).at("parameters").at("force");
  EXPECT_EQ(force.at("ci95"), json({20.206, nullptr}));
  EXPECT_TRUE(document.at("mismatch").at("after").at("train").at("q").is_null());
  EXPECT_TRUE(document.at("gain").at("train").is_null());
  EXPECT_TRUE(document.at("fault_limits").at(1).at("before").is_null());
}

}  // namespace
}  // namespace mjdiag
