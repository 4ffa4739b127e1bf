#include "mjdiag/diagnosis/filters_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "diagnosis/test_design.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// With everything that a file can hold.
DiagnosisDesign Design() {
  DiagnosisDesign design = test::StageDesign();
  design.setup = "stage";
  design.disturbance.prefilters = Outputs(design.bank.filters, 4, 3);
  design.options.horizon = 0.3;
  design.limits.residual.alpha = 2.0;
  design.limits.residual.fit = {0.1, 1.0 / 3.0};
  design.limits.residual.histogram = {{-1.0, 0.0, 1.0}, {3, 5}};
  design.limits.estimates = {{-1e-3, 2e-3}, {-0.1, 0.1}, {0.0, 1.0}, {-1.0, 1.0}};
  design.limits.disturbance.segment = 64;
  design.limits.disturbance.nominal = {Eigen::Vector3d(0.0, 1.0, 2.0),
                                       Eigen::Vector3d(0.1, 0.2, 0.3)};
  design.limits.disturbance.highest = Eigen::Vector3d(1.0 / 7.0, 0.3, 0.4);
  return design;
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(FiltersFile, GivesBackTheSameDiagnosisToTheLastBit) {
  const DiagnosisDesign design = Design();
  const test::TemporaryFolder folder;
  WriteFilters(folder / "filters.json", design);
  const DiagnosisDesign read = ReadFilters(folder / "filters.json");
  EXPECT_EQ(FiltersJson(read), FiltersJson(design));
  EXPECT_EQ(read.bank.filters.B, design.bank.filters.B);
  EXPECT_EQ(read.disturbance.prefilters.D, design.disturbance.prefilters.D);
  EXPECT_EQ(read.options.horizon, design.options.horizon);
  EXPECT_EQ(read.limits.residual.fit.sd, design.limits.residual.fit.sd);
  EXPECT_EQ(read.limits.disturbance.highest, design.limits.disturbance.highest);
  ASSERT_EQ(read.limits.estimates.size(), 4);
  EXPECT_EQ(read.limits.estimates[0].max, 2e-3);
}

TEST(FiltersFile, HasNoLimitsBeforeTheyAreKnown) {
  DiagnosisDesign design = Design();
  design.limits = {};
  const test::TemporaryFolder folder;
  WriteFilters(folder / "filters.json", design);
  EXPECT_FALSE(ReadFilters(folder / "filters.json").limits.known);
}

TEST(FiltersFile, NamesWhatIsWrong) {
  const test::TemporaryFolder folder;
  const std::string text = FiltersJson(Design());
  const auto message = [&](const std::string& changed) {
    const std::string file = folder.Write("filters.json", changed);
    return test::MessageOf<InputError>([&] { ReadFilters(file); });
  };
  EXPECT_THAT(message(Replaced(text, "\"stride\"", "\"strode\"")), HasSubstr("stride"));
  EXPECT_THAT(message(Replaced(text, "mjdiag.filters/1", "something/1")),
              HasSubstr("schema"));
  EXPECT_THAT(message(Replaced(text, "\"residuals\": 4", "\"residuals\": 3")),
              HasSubstr("shapes"));
  EXPECT_THAT(message("{"), HasSubstr("filters.json"));
  EXPECT_THAT(test::MessageOf<InputError>([&] { ReadFilters(folder / "none.json"); }),
              HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace mjdiag
