#include "mjdiag/studies/hidden_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/studies/hidden_table.h"
#include "mjdiag/studies/outside_law.h"

namespace mjdiag {
namespace {

const std::vector<Cause>& Catalogue() {
  static const std::vector<Cause> causes = [] {
    std::vector<Cause> all;
    for (const Effect* effect : Effects()) {
      for (const char* site : {"X", "Y", "Z"}) {
        const auto count = static_cast<Eigen::Index>(effect->parameters().size());
        all.push_back({Lasting(*effect), site, EffectValues::Ones(count)});
      }
    }
    return all;
  }();
  return causes;
}

FoundCause Named(const Cause& cause, double probability = 0.8) {
  FoundCause found;
  found.cause = cause;
  found.probability = probability;
  return found;
}

FoundCause Named(const Cause& cause, const Cause& instead, double probability) {
  FoundCause found = Named(cause);
  found.alternatives = {{instead, probability, false}};
  return found;
}

/// A truth of one to three, and causes that are none of it.
struct Drawn {
  std::vector<Cause> truth;
  std::vector<Cause> others;
};

Drawn DrawTruth(std::mt19937_64& random) {
  std::vector<Cause> all = Catalogue();
  std::ranges::shuffle(all, random);
  const auto causes = static_cast<std::ptrdiff_t>(1 + random() % 3);
  return {{all.begin(), all.begin() + causes},
          {all.begin() + causes, all.begin() + causes + 5}};
}

std::vector<FoundCause> AllNamed(std::vector<Cause> causes, std::mt19937_64& random) {
  std::ranges::shuffle(causes, random);
  std::vector<FoundCause> found;
  for (const Cause& cause : causes) found.push_back(Named(cause));
  return found;
}

// Whatever is hidden: what each verdict means, of answers that are made up.
TEST(HiddenVerdict, FollowsFromWhatIsNamedWhateverTheTruth) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i) {
    const auto [truth, others] = DrawTruth(random);
    std::vector<FoundCause> found = AllNamed(truth, random);
    EXPECT_EQ(VerdictOf(truth, found), HiddenVerdict::kRight);
    EXPECT_EQ(VerdictOf(truth, {}), HiddenVerdict::kSilent);

    std::vector<FoundCause> more = found;
    more.push_back(Named(others[0]));
    EXPECT_EQ(VerdictOf(truth, more), HiddenVerdict::kWrong);

    // A false name is excused by what it may be instead, once.
    const Cause last = found.back().cause;
    found.back() = Named(others[0], last, 0.06);
    EXPECT_EQ(VerdictOf(truth, found), HiddenVerdict::kUndecided);
    more = found;
    more.push_back(Named(others[1], last, 0.06));
    EXPECT_EQ(VerdictOf(truth, more), HiddenVerdict::kWrong);
    more.back() = Named(last);
    EXPECT_EQ(VerdictOf(truth, more), HiddenVerdict::kWrong);
    found.back() = Named(others[0], last, 0.04);
    EXPECT_EQ(VerdictOf(truth, found), HiddenVerdict::kWrong);

    found.pop_back();
    EXPECT_EQ(VerdictOf(truth, found), HiddenVerdict::kSilent);
  }
}

TEST(HiddenVerdict, CountsWhatNoMeasurementTellsApartAsOne) {
  const Machine bonder(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"));
  const Cause motor = ParseEffect("motor_constant@x_motor:factor=0.7");
  const std::vector<Cause> twins = EquivalentCauses(bonder.plant(), motor);
  ASSERT_EQ(twins.size(), 1u);
  EXPECT_EQ(VerdictOf({motor}, {Named(twins[0])}), HiddenVerdict::kRight);
}

TEST(HiddenVerdict, OfNothingIsWrongWithAnyName) {
  EXPECT_EQ(VerdictOf({}, {}), HiddenVerdict::kRight);
  EXPECT_EQ(VerdictOf({}, {Named(Catalogue()[0], 0.1)}), HiddenVerdict::kWrong);
}

TEST(OutsideVerdict, AcceptsTheFamilyAtTheJointAndNoOtherNameAboveOneHalf) {
  const Effect& law = RootFriction();
  const FoundCause friction = Named(ParseEffect("viscous_friction@X:coefficient=1"));
  const FoundCause ripple =
      Named(ParseEffect("force_ripple@X:amplitude=1,period=0.1"), 0.51);
  EXPECT_EQ(VerdictOf(law, 3, {}, {}), OutsideVerdict::kNothing);
  EXPECT_EQ(VerdictOf(law, 3, {friction}, {3}), OutsideVerdict::kFamily);
  EXPECT_EQ(VerdictOf(law, 3, {friction}, {4}), OutsideVerdict::kFalse);
  EXPECT_EQ(VerdictOf(law, 3, {friction, ripple}, {3, 3}), OutsideVerdict::kFalse);
  FoundCause unsure = ripple;
  unsure.probability = 0.5;
  EXPECT_EQ(VerdictOf(law, 3, {unsure}, {3}), OutsideVerdict::kNothing);
}

TEST(Claims, HoldForEachCauseOnce) {
  const Cause one = Catalogue()[0];
  const Cause other = Catalogue()[4];
  const std::vector<Claim> claims =
      ClaimsOf({one}, {Named(other, 0.7), Named(one, 0.9), Named(one, 0.6)});
  ASSERT_EQ(claims.size(), 3u);
  EXPECT_FALSE(claims[0].holds);
  EXPECT_TRUE(claims[1].holds);
  EXPECT_EQ(claims[1].probability, 0.9);
  EXPECT_FALSE(claims[2].holds);
}

TEST(Reliability, CountsClaimsInTheBinOfTheirProbability) {
  std::vector<Claim> claims = {{0.0, false}, {0.5, true}, {1.0, true}, {0.995, true}};
  for (int i = 0; i < 10; ++i) claims.push_back({0.8, i < 8});
  const std::vector<ReliabilityBin> bins = ReliabilityOf(claims);
  ASSERT_EQ(bins.size(), 3u);
  EXPECT_EQ(bins[0].to, 0.5);
  EXPECT_EQ(bins[0].claims, 2);
  EXPECT_EQ(bins[0].hold, 1);
  EXPECT_DOUBLE_EQ(bins[0].mean, 0.25);
  EXPECT_EQ(bins[1].claims, 10);
  EXPECT_EQ(bins[1].hold, 8);
  EXPECT_NEAR(bins[1].mean, 0.8, 1e-12);
  // Clopper and Pearson of 8 of 10.
  EXPECT_NEAR(bins[1].interval.first, 0.4439, 1e-4);
  EXPECT_NEAR(bins[1].interval.second, 0.9748, 1e-4);
  EXPECT_EQ(bins[2].from, 0.99);
  EXPECT_EQ(bins[2].claims, 2);
}

std::string CountOf(const StudyTable& table, const std::string& figure) {
  for (const auto& row : table.rows) {
    if (row[0].text == figure) return row[1].text;
  }
  return "";
}

TEST(HiddenSummary, CountsEveryKindOfCaseByItself) {
  HiddenOutcome right;
  right.truth = {Catalogue()[0]};
  right.claims = {{0.95, true}};
  right.answer.budget = {50.0, 120.0, false, {}};
  HiddenOutcome wrong = right;
  wrong.verdict = HiddenVerdict::kWrong;
  wrong.claims = {{0.95, false}};
  wrong.answer.budget.used = 130.0;
  HiddenOutcome outside = right;
  outside.plan.outside = true;
  outside.truth = {{Lasting(RootFriction()), "X", ValuesOf({1.0, 1.0})}};
  outside.outside = OutsideVerdict::kFalse;
  outside.claims = {{0.95, false}};
  HiddenOutcome nothing;
  nothing.answer.budget = {10.0, 120.0, false, {}};
  const auto tables = SummariesOf({right, wrong, right, outside, nothing});
  EXPECT_EQ(CountOf(tables[0], "catalogue, right"), "2 of 3");
  EXPECT_EQ(CountOf(tables[0], "catalogue, wrong with a probability above 0.9"),
            "1 of 3");
  EXPECT_EQ(CountOf(tables[0], "outside law, false name"), "1 of 1");
  EXPECT_EQ(CountOf(tables[0], "nothing hidden, something claimed"), "0 of 1");
  EXPECT_EQ(CountOf(tables[0], "within the budget"), "4 of 5");
  EXPECT_EQ(CountOf(tables[0], "outside law, its kind at its site"), "0 of 1");
  // Outside laws have no true name that a probability could be one of.
  ASSERT_EQ(tables[1].rows.size(), 1u);
  EXPECT_EQ(tables[1].rows[0][1].number, 3.0);
  EXPECT_EQ(tables[1].rows[0][3].number, 2.0);
  ASSERT_TRUE(tables[1].plot);
  EXPECT_NEAR(tables[1].plot->points[0].y, 2.0 / 3.0, 1e-12);
}

TEST(HiddenKinds, AreThereWhateverTheirLaws) {
  const Cause friction{Lasting(CoulombFriction()), "X", ValuesOf({1.0})};
  const Cause law{Lasting(RootFriction()), "Y", ValuesOf({1.0, 1.0})};
  const std::vector<Cause> truth = {friction, law};
  const FoundKind dry{Kind::kDryFriction, "X", 0.99, 0.8};
  const FoundKind viscous{Kind::kViscousFriction, "Y", 0.9, 0.2};
  EXPECT_TRUE(HasKindsOf(truth, {dry, viscous}));
  EXPECT_FALSE(HasKindsOf(truth, {dry}));
  EXPECT_FALSE(HasKindsOf(truth, {dry, {Kind::kViscousFriction, "X", 0.9}}));
  EXPECT_FALSE(HasKindsOf(truth, {dry, {Kind::kViscousFriction, "Y", 0.4}}));
  // A number that is another one is no claim, a kind that is not there a false one.
  const FoundKind number{Kind::kInertia, "X", 0.99, 0.0, true};
  const auto claims = ClaimsOf(truth, {dry, number, {Kind::kPlay, "X", 0.6}});
  ASSERT_EQ(claims.size(), 2u);
  EXPECT_TRUE(claims[0].holds);
  EXPECT_FALSE(claims[1].holds);
}

TEST(HiddenVerdict, TakesAForceWithoutANameForNoName) {
  const Cause hidden = Catalogue().front();
  FoundCause curve = Named({Lasting(ForceCurve()), "X", {}}, 1.0);
  curve.unnamed = "1 N rms at X that follow Y velocity";
  EXPECT_EQ(VerdictOf({hidden}, {curve}), HiddenVerdict::kSilent);
  EXPECT_EQ(VerdictOf({hidden}, {Named(hidden), curve}), HiddenVerdict::kUndecided);
  EXPECT_TRUE(ClaimsOf({hidden}, std::vector<FoundCause>{curve}).empty());
  EXPECT_EQ(VerdictOf(CoulombFriction(), 0, {curve}, {1}), OutsideVerdict::kNothing);
  curve.unnamed.clear();
  EXPECT_EQ(VerdictOf({hidden}, {curve}), HiddenVerdict::kWrong);
}

}  // namespace
}  // namespace mjdiag
