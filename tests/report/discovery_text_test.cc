#include "mjdiag/report/discovery_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/mismatch_tables.h"
#include "report/sample_discovery.h"

namespace mjdiag {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using Row = std::vector<std::string>;

TEST(DiscoveryAnswer, NamesTheCausesAndWhatTheyGained) {
  EXPECT_EQ(DiscoveryAnswer(SampleDiscovery()),
            "The model is wrong about dry friction at load (a resistance that does not "
            "grow with "
            "speed). "
            "Found: coulomb_friction at load (force 20.39 N) and eta = 1.034200. Noise "
            "explains the rest. On unseen data the mismatch falls by 97.2 %, to 1.10 "
            "times the noise floor.");
}

TEST(DiscoveryAnswer, SaysThatSomethingIsLeft) {
  Discovery discovery = SampleDiscovery();
  discovery.verdict = DiscoveryVerdict::kPartlyExplained;
  discovery.unexplained = SampleUnexplained().unexplained;
  EXPECT_THAT(DiscoveryAnswer(discovery),
              HasSubstr("Something is left. The force that is left at load"));
}

TEST(DiscoveryAnswer, NamesNoCauseForWhatNoneExplains) {
  EXPECT_EQ(DiscoveryAnswer(SampleUnexplained()),
            "Something is there that no known cause explains. The force that is left "
            "at load is a fourth power of its position.");
}

TEST(DiscoveryAnswer, NamesNothingForNoise) {
  Discovery discovery = SampleDiscovery();
  discovery.verdict = DiscoveryVerdict::kNoDiscrepancy;
  EXPECT_THAT(DiscoveryAnswer(discovery), Not(HasSubstr("friction")));
}

TEST(ValueText, ShowsTwoDigitsOfTheIntervalsHalfWidth) {
  const CauseParameter force{"force", "N", 20.39, 0.094, 20.206, 20.574};
  EXPECT_EQ(ValueText(force), "20.39 N");
  EXPECT_EQ(IntervalText(force), "20.21 to 20.57 N");
}

TEST(ValueText, TakesOnePrefixForTheValueAndItsInterval) {
  const CauseParameter gap{"gap", "m", 9.9e-7, 1e-8, 9.7e-7, 1.01e-6};
  EXPECT_EQ(ValueText(gap), "0.990 µm");
  EXPECT_EQ(IntervalText(gap), "0.970 to 1.010 µm");
}

TEST(ValueText, WritesExponentsWhereNoPrefixFits) {
  const CauseParameter cubic{"coefficient", "1/m^3", 2.5e9, 1e7, 2.48e9, 2.52e9};
  EXPECT_EQ(ValueText(cubic), "2.500e+09 1/m³");
}

TEST(ValueText, HasFourDigitsWithoutAnInterval) {
  EXPECT_EQ(ValueText({"force", "N", 3.16482, 0.0, 3.16482, 3.16482}), "3.165 N");
}

TEST(GainText, ShowsTwoDigitsOfWhatIsLeft) {
  EXPECT_EQ(GainText(0.99975), "99.975 %");
  EXPECT_EQ(GainText(0.9725), "97.2 %");
  EXPECT_EQ(GainText(0.3), "30 %");
  EXPECT_EQ(GainText(1.0), "100 %");
}

TEST(TimesFloor, LeavesOutChannelsWithoutNoise) {
  EXPECT_DOUBLE_EQ(*TimesFloor({{"a", 3.0}, {"b", 4.0}, {"c", 9.0}},
                               {{"a", 1.0}, {"b", 1.0}, {"c", 0.0}}),
                   std::sqrt(12.5));
  EXPECT_FALSE(TimesFloor({{"c", 9.0}}, {{"c", 0.0}}).has_value());
}

TEST(DiscoveryTables, HaveARowForEveryParameter) {
  Discovery discovery = SampleDiscovery();
  discovery.causes[0].parameters.push_back({"velocity", "m/s", 0.1, 0.01, 0.08, 0.12});
  const Table table = CauseTable(discovery);
  EXPECT_THAT(
      table.rows,
      ElementsAre(
          Row{"coulomb_friction", "load", "force", "20.39 N", "20.21 to 20.57 N",
              "96.3 %", "stribeck_friction at load, 3.10 %"},
          Row{"", "", "velocity", "100 mm/s", "80 to 120 mm/s", "", ""},
          Row{"eta", "drive", "value", "1.034200", "1.034160 to 1.034240", "100 %",
              "motor_constant at drive, alike"}));
}

TEST(ExplanationTable, HasARowForEverySetThatSurvives) {
  const Table table = ExplanationTable(SampleDiscovery());
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_THAT(table.rows[1],
              ElementsAre("49.1 %", "█████░░░░░",
                          "coulomb_friction at load and motor_constant at drive"));
}

TEST(ExplanationTable, IsLeftOutWhereOneSetSurvives) {
  Discovery discovery = SampleDiscovery();
  for (FoundCause& found : discovery.causes) found.alternatives.clear();
  EXPECT_TRUE(ExplanationTable(discovery).rows.empty());
}

TEST(DiscoveryTables, ListEveryCandidateOfAPlace) {
  const Table table = CandidateTable(SampleDiscovery());
  ASSERT_EQ(table.rows.size(), 5u);
  EXPECT_EQ(table.rows[0][2], "██████████");
  EXPECT_THAT(table.rows[1],
              ElementsAre("", "stribeck_friction at load", "░░░░░░░░░░", "3.10 %", ""));
  EXPECT_EQ(table.rows[4][4], "no measurement tells them apart");
}

TEST(DiscoveryTables, ShowErrorsAfterEachCauseOnBothRecords) {
  const Table ladder = LadderTable(SampleDiscovery());
  EXPECT_EQ(ladder.columns.back().title, "q");
  EXPECT_THAT(ladder.rows[1], ElementsAre("coulomb_friction@load", "1.20", "1.30",
                                          "4.60 %", "0.0100 %"));
  const Table validation = ValidationLadderTable(SampleDiscovery());
  EXPECT_THAT(validation.rows, ElementsAre(Row{"nothing", "17.0 %"},
                                           Row{"coulomb_friction@load", "6.00 %"}));
}

TEST(DiscoveryTables, HaveNoValidationWithoutSuchARecord) {
  Discovery discovery = SampleDiscovery();
  for (LadderStep& step : discovery.ladder) step.validation_percent.clear();
  EXPECT_TRUE(ValidationLadderTable(discovery).rows.empty());
}

TEST(DiscoveryTables, ShowTheMismatchOverItsFloor) {
  EXPECT_THAT(MismatchTable(SampleDiscovery()).rows,
              ElementsAre(Row{"q", "100 nm", "3.50 µm", "100 nm", "4.00 µm", "110 nm",
                              "1.10"}));
}

TEST(DiscoveryTables, SayHowMuchSmallerAFaultIsSeen) {
  EXPECT_THAT(FaultLimitTable(SampleDiscovery()).rows,
              ElementsAre(Row{"zeta", "20.0 %", "1.00 %", "20.0"},
                          Row{"beta", "∞ %", "50.0 %", "-"}));
}

}  // namespace
}  // namespace mjdiag
