#include "mjdiag/report/field_reference.h"

#include <gtest/gtest.h>

#include <limits>

#include "mjdiag/signals/fields.h"
#include "mjdiag/signals/fields_json.h"

namespace mjdiag {

struct SampleAxis {
  std::string name;
  double wear = 0.0;
};
struct SampleAnswer {
  std::vector<SampleAxis> axes;
  std::optional<double> age;
  IfAny<double> load;
};

template <>
inline constexpr auto kFields<SampleAxis> =
    std::tuple{InPython("name", "", "Of the axis.", &SampleAxis::name),
               Everywhere("wear", "mm", "How much is gone.", &SampleAxis::wear)};
template <>
inline constexpr auto kFields<SampleAnswer> = std::tuple{
    Everywhere("axes", "", "All of them.",
               [](const SampleAnswer& answer) {
                 return NamedBy(answer.axes, &SampleAxis::name, std::identity());
               }),
    InJson("span", "mm", "From (low, high).",
           [](const SampleAnswer&) {
             return std::pair{0.5, std::numeric_limits<double>::infinity()};
           }),
    InJson("worst", "", "The first.", &SampleAnswer::axes),
    Everywhere("age", "s", "Since when.", &SampleAnswer::age),
    Everywhere("load", "N", "If it was measured.", &SampleAnswer::load)};

namespace {

TEST(Fields, AreWhatJsonHas) {
  const SampleAnswer answer{{{"x", 0.25}}, std::nullopt, {}};
  EXPECT_EQ(JsonOf(answer), nlohmann::json::parse(R"({"axes": {"x": {"wear": 0.25}},
              "span": [0.5, null], "worst": [{"wear": 0.25}], "age": null})"));
}

TEST(Fields, AreLeftOutOfJsonOnlyWithoutAValue) {
  const SampleAnswer answer{{}, 2.0, 3.0};
  EXPECT_EQ(JsonOf(answer), nlohmann::json::parse(R"({"axes": {}, "span": [0.5, null],
              "worst": [], "age": 2.0, "load": 3.0})"));
}

TEST(Fields, AreTheReferenceOfTheDocument) {
  EXPECT_EQ(FieldReference<SampleAnswer>(),
            "axes: All of them.\n"
            "axes.<name>.wear [mm]: How much is gone.\n"
            "span [mm]: From (low, high).\n"
            "worst: The first.\n"
            "worst[].wear [mm]: How much is gone.\n"
            "age [s]: Since when.\n"
            "load [N]: If it was measured.\n");
}

}  // namespace
}  // namespace mjdiag
