#include "mjdiag/discovery/selection/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "mjdiag/discovery/selection/comparator.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A record of one channel, 700 of its samples fitted and 300 held out, and fits of it
// that are made up: what they leave has one size in each part.
constexpr Index kFitted = 700;
constexpr Index kSamples = 1000;
const EvidenceData kRecord{
    .skip = 0, .train = kFitted, .samples = kSamples, .replay = {}};
constexpr Chance kChance{.probability = 1e-4, .trials = 100, .unsteadiness = 0.0};

using Numbers = std::vector<std::size_t>;

/// Candidates of those numbers, one parameter each, with what their fit leaves.
CauseFit FitOf(const Numbers& candidates, double fitted, double held_out) {
  CauseFit fit;
  for (const std::size_t candidate : candidates) {
    fit.causes.push_back({candidate, VectorXd::Ones(1)});
  }
  fit.residual = VectorXd::Constant(kSamples, held_out);
  fit.residual.head(kFitted).setConstant(fitted);
  fit.train = fitted * fitted;
  fit.held_out = held_out * held_out;
  return fit;
}

Evidence Present(const Numbers& candidates, double fitted, double held_out,
                 const EvidenceData& data = kRecord) {
  return {data, FitOf(candidates, fitted, held_out), VectorXd::Ones(1)};
}

Evidence Adding(const Evidence& present, const CauseFit& fit, double share = 1.0,
                const Chance& chance = kChance) {
  return present.Added(fit, VectorXd::Constant(1, share), chance);
}

/// What is left where noise alone would leave 1, with that less deviance.
double Less(double deviance, Index samples) {
  return std::sqrt(1.0 - deviance / static_cast<double>(samples));
}

/// Another record, of which each set leaves as much as the number of its hypotheses
/// says; counts how often it is replayed.
EvidenceData WithOtherRecord(const std::vector<double>& left, int& replays) {
  EvidenceData data = kRecord;
  data.replay = [left, &replays](const FittedModel& model) -> VectorXd {
    ++replays;
    return VectorXd::Constant(500, left[model.causes.size()]);
  };
  return data;
}

TEST(Evidence, HasTheCriterionOfTheFittedPartAlone) {
  const Evidence evidence = Present({0, 1}, 3.0, 100.0);
  EXPECT_NEAR(evidence.Criterion(),
              700.0 * (std::log(9.0) + 1.0) + 2.0 * std::log(700.0), 1e-9);
  // Of a quarter of the samples, which is all that is independent.
  EXPECT_NEAR(evidence.Criterion(VectorXd::Constant(1, 0.25)),
              175.0 * (std::log(9.0) + 1.0) + 2.0 * std::log(175.0), 1e-9);
}

TEST(Evidence, OfUnseenDataIsOfThePartHeldOutAndOfOtherRecords) {
  const VectorXd all = VectorXd::Ones(1);
  const double held_out = 300.0 * (std::log(4.0) + 1.0);
  EXPECT_NEAR(Present({0}, 1.0, 2.0).Unseen(all), held_out, 1e-9);
  int replays = 0;
  const EvidenceData data = WithOtherRecord({3.0, 3.0}, replays);
  EXPECT_NEAR(Present({0}, 1.0, 2.0, data).Unseen(all),
              held_out + 500.0 * (std::log(9.0) + 1.0), 1e-9);
}

TEST(Evidence, IsInfinitelyBadWhereAnotherRecordCannotBeRun) {
  EvidenceData data = kRecord;
  data.replay = [](const FittedModel&) { return VectorXd(); };
  EXPECT_TRUE(std::isinf(Present({0}, 1.0, 1.0, data).Unseen(VectorXd::Ones(1))));
}

TEST(Evidence, TakesAGainForLessWhereTheRestIsLargeOrColouredOrUnsteady) {
  const auto gain = [](double left, double share, double unsteadiness) {
    const Chance chance{.probability = 1e-4, .unsteadiness = unsteadiness};
    return Present({}, left, 1.0)
        .SignificanceOf(100.0, 1, chance, VectorXd::Constant(1, share))
        .gain;
  };
  EXPECT_DOUBLE_EQ(gain(1.0, 1.0, 0.0), 100.0);
  EXPECT_DOUBLE_EQ(gain(2.0, 1.0, 0.0), 25.0);
  EXPECT_DOUBLE_EQ(gain(1.0, 0.5, 0.0), 50.0);
  EXPECT_DOUBLE_EQ(gain(1.0, 1.0, 30.0), 70.0);
}

TEST(Comparator, AcceptsAnAdditionThatExplainsEverywhere) {
  const Evidence present = Present({}, 2.0, 2.0);
  EXPECT_EQ(Judge(present, Adding(present, FitOf({0}, 1.2, 1.2))),
            Judgement::kAccepted);
}

// A parameter costs log 700 = 6.55.
TEST(Comparator, RejectsAnAdditionThatGainsLessThanItsParametersCost) {
  const Chance easy{.probability = 0.5};
  const Evidence present = Present({}, 1.0, 1.0);
  EXPECT_EQ(
      Judge(present, Adding(present, FitOf({0}, Less(6.0, kFitted), 1.0), 1.0, easy)),
      Judgement::kCriterion);
  EXPECT_EQ(
      Judge(present, Adding(present, FitOf({0}, Less(7.0, kFitted), 1.0), 1.0, easy)),
      Judgement::kAccepted);
}

// The best of a hundred reaches 23.9 by chance once in 10^4 times.
TEST(Comparator, RejectsAnAdditionThatMayBeChance) {
  const Evidence present = Present({}, 1.0, 1.0);
  const auto judge = [&](double gain, const Chance& chance) {
    return Judge(present,
                 Adding(present, FitOf({0}, Less(gain, kFitted), 1.0), 1.0, chance));
  };
  EXPECT_EQ(judge(20.0, kChance), Judgement::kChance);
  EXPECT_EQ(judge(30.0, kChance), Judgement::kAccepted);
  EXPECT_EQ(judge(20.0, {.probability = 1e-4, .trials = 1}), Judgement::kAccepted);
  EXPECT_EQ(judge(30.0, {.probability = 1e-4, .trials = 100, .unsteadiness = 10.0}),
            Judgement::kChance);
}

TEST(Comparator, RejectsALargerSetOfWhichNobodyKnowsWhetherItIsChance) {
  const Evidence present = Present({}, 2.0, 2.0);
  EXPECT_EQ(Judge(present, present.Changed(FitOf({0}, 1.2, 1.2))), Judgement::kChance);
}

TEST(Comparator, RejectsAnAdditionThatSpoilsThePartHeldOut) {
  const Evidence present = Present({}, 2.0, 2.0);
  EXPECT_EQ(Judge(present, Adding(present, FitOf({0}, 1.2, 2.001))),
            Judgement::kUnseen);
}

// Numbers that are far off fit as well as the cause: 700 samples, 80 and 20 units of what
// is known beforehand.
TEST(Comparator, LetsWhatIsKnownBeforehandSpeakForAnAdditionOnUnseenData) {
  CauseFit far_off = FitOf({}, 1.0, 1.0);
  far_off.prior = 80.0;
  const Evidence present(kRecord, far_off, VectorXd::Ones(1));
  const auto judge = [&](double held_out) {
    CauseFit fit = FitOf({0}, 1.0, held_out);
    fit.prior = 20.0;
    return Judge(present, Adding(present, fit));
  };
  const auto lost = [](double held_out) {
    return 300.0 * 2.0 * std::log(held_out);  // n log s^2 where m = s^2 > 1
  };
  ASSERT_LT(lost(1.10), 60.0);
  ASSERT_GT(lost(1.11), 60.0);
  EXPECT_EQ(judge(1.10), Judgement::kAccepted);
  EXPECT_EQ(judge(1.11), Judgement::kUnseen);
}

TEST(Comparator, RejectsAnAdditionThatSpoilsAnotherRecord) {
  int replays = 0;
  const Evidence present = Present({}, 2.0, 2.0, WithOtherRecord({1.0, 4.0}, replays));
  EXPECT_EQ(Judge(present, Adding(present, FitOf({0}, 1.2, 1.2))), Judgement::kUnseen);
}

TEST(Comparator, LearnsNothingFromARecordThatNeitherSetCanBeRunOn) {
  EvidenceData data = kRecord;
  data.replay = [](const FittedModel&) { return VectorXd(); };
  const Evidence present = Present({}, 2.0, 2.0, data);
  EXPECT_EQ(Judge(present, Adding(present, FitOf({0}, 1.2, 9.0))),
            Judgement::kAccepted);
}

TEST(Comparator, ReplaysOtherRecordsOnlyWhereTheyDecideAndOnceASet) {
  int replays = 0;
  const Evidence present = Present({}, 1.0, 1.0, WithOtherRecord({1.0, 1.0}, replays));
  const Evidence worse = Adding(present, FitOf({0}, 1.0, 1.0));
  const Evidence chance = Adding(present, FitOf({0}, Less(20.0, kFitted), 1.0));
  EXPECT_EQ(Judge(present, worse), Judgement::kCriterion);
  EXPECT_EQ(Judge(present, chance), Judgement::kChance);
  EXPECT_EQ(replays, 0);
  const Evidence good = Adding(present, FitOf({0}, Less(50.0, kFitted), 1.0));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Judge(present, good), Judgement::kAccepted);
  EXPECT_EQ(replays, 2);
}

// 700 log(4 / 2.25) = 403 gained.
TEST(Comparator, LetsAnExchangeLoseOnUnseenDataLessThanItGains) {
  const Evidence present = Present({0, 1}, 2.0, 2.0);
  const auto judge = [&](double held_out) {
    return Judge(present, present.Changed(FitOf({0, 2}, 1.5, held_out)));
  };
  EXPECT_EQ(judge(2.5), Judgement::kAccepted);  // 134 lost
  EXPECT_EQ(judge(4.0), Judgement::kUnseen);    // 416
  EXPECT_EQ(Judge(present, present.Changed(FitOf({0, 2}, 2.01, 1.0))),
            Judgement::kCriterion);
}

TEST(Comparator, LetsADropLoseOnUnseenDataLessThanItSaves) {
  const Evidence present =
      Present({0, 1}, Less(2.0, kFitted), Less(20.0, kSamples - kFitted));
  // Saves log 700 - 2 = 4.55.
  const auto judge = [&](double lost) {
    return Judge(present, present.Changed(
                              FitOf({0}, 1.0, Less(20.0 - lost, kSamples - kFitted))));
  };
  EXPECT_EQ(judge(4.0), Judgement::kAccepted);
  EXPECT_EQ(judge(5.0), Judgement::kUnseen);
  const Evidence needed = Present({0, 1}, Less(10.0, kFitted), 1.0);
  EXPECT_EQ(Judge(needed, needed.Changed(FitOf({0}, 1.0, 1.0))), Judgement::kCriterion);
}

TEST(Comparator, AsksMoreThanAUnitOfOtherValuesOfTheSameHypotheses) {
  const Evidence present = Present({0, 1}, 1.0, 1.0);
  const auto judge = [&](const Numbers& candidates, double gain) {
    return Judge(present, present.Changed(FitOf(candidates, Less(gain, kFitted), 1.0)));
  };
  EXPECT_EQ(judge({1, 0}, 0.9), Judgement::kCriterion);
  EXPECT_EQ(judge({1, 0}, 1.1), Judgement::kAccepted);
  EXPECT_EQ(judge({1, 2}, 0.9), Judgement::kAccepted);
}

TEST(Comparator, CountsBothSetsByWhatTheLargerOneLeaves) {
  const Evidence present = Present({}, 1.0, 1.0);
  const CauseFit fit = FitOf({0}, Less(50.0, kFitted), 1.0);
  EXPECT_EQ(Judge(present, Adding(present, fit, 1.0)), Judgement::kAccepted);
  // 20 are left, which is less than chance; then 2.5, less than the parameter costs.
  EXPECT_EQ(Judge(present, Adding(present, fit, 0.4)), Judgement::kChance);
  EXPECT_EQ(Judge(present, Adding(present, fit, 0.05)), Judgement::kCriterion);
}

TEST(Comparator, LeavesNoTraceOfASetThatItTurnsDown) {
  const Evidence present = Present({}, 1.0, 1.0);
  const double criterion = present.Criterion();
  const CauseFit fit = FitOf({0}, Less(50.0, kFitted), 1.0);
  ASSERT_EQ(Judge(present, Adding(present, fit, 0.05)), Judgement::kCriterion);
  EXPECT_EQ(present.independent()[0], 1.0);
  EXPECT_EQ(present.Criterion(), criterion);
  EXPECT_EQ(Judge(present, Adding(present, fit, 1.0)), Judgement::kAccepted);
}

TEST(Comparator, TakesTheBestOfSeveralProposals) {
  const Evidence present = Present({0, 1}, 2.0, 2.0);
  const std::optional<Evidence> worse = present.Changed(FitOf({0, 2}, 3.0, 2.0));
  const std::optional<Evidence> better = present.Changed(FitOf({0, 3}, 1.5, 2.0));
  const std::optional<Evidence> best = present.Changed(FitOf({0, 4}, 1.2, 2.0));
  const std::optional<Evidence> spoils = present.Changed(FitOf({0, 5}, 1.1, 9.0));
  EXPECT_EQ(BestOf(present, {worse, better, std::nullopt, best, spoils}), 3u);
  EXPECT_EQ(BestOf(present, {best, better}), 0u);
  EXPECT_EQ(BestOf(present, {worse, std::nullopt, spoils}), std::nullopt);
}

/// Unseen records of which free simulation leaves as much as the number of hypotheses
/// says.
EvidenceData WithFreeRun(const std::vector<double>& left) {
  EvidenceData data = kRecord;
  data.free_run = [left](const FittedModel& model) {
    return left[model.causes.size()];
  };
  return data;
}

TEST(Comparator, TurnsDownWhatSpoilsFreeSimulationWhereMuchIsLeft) {
  const auto judge = [](double left, double after) {
    const Evidence present = Present({0}, left, 1.0, WithFreeRun({0.0, 1.0, after}));
    return Judge(present, Adding(present, FitOf({0, 1}, 0.5 * left, 1.0)));
  };
  EXPECT_EQ(judge(10.0, 1.019), Judgement::kAccepted);
  EXPECT_EQ(judge(10.0, 1.021), Judgement::kUnseen);
  // Near the noise the innovations know better.
  EXPECT_EQ(judge(1.9, 1.5), Judgement::kAccepted);
}

TEST(Evidence, WeighsWhatIsKnownBeforehandByWhatIsLeft) {
  EXPECT_EQ(Present({0}, 1.0, 1.0).fit().prior_weight, 1.0);
  const Evidence coloured(kRecord, FitOf({0}, 3.0, 1.0), VectorXd::Constant(1, 0.25));
  EXPECT_EQ(coloured.fit().prior_weight, 9.0 / 0.25);
}

}  // namespace
}  // namespace mjdiag
