#include "mjdiag/discovery/answer/unseen_judgement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "mjdiag/discovery/answer/missing_share.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kDamper = "viscous_friction@elbow:coefficient=0.05";
constexpr const char* kOther = "viscous_friction@shoulder:coefficient=0.2";

/// What is found in a record of an arm that lacks something: once, however many other records
/// it is judged by.
const Explained& ExplainedOf(const std::vector<std::string>& lacking,
                             const Machine& machine, const MeasuredRun& record,
                             const Eigen::VectorXd& sd) {
  static std::map<std::vector<std::string>, Explained> known;
  const auto at = known.find(lacking);
  if (at != known.end()) return at->second;
  return known.emplace(lacking, Explain(machine, record, sd, {.seconds = 300.0}))
      .first->second;
}

/// What is found in one record of an arm, and what another says of it.
struct Judged {
  Judged(const std::vector<std::string>& seen, const std::vector<std::string>& unseen)
      : run{ToMeasuredRun(arm.setup(), test::Arm::Measure(seen, 1.0, 64)),
            ToMeasuredRun(arm.setup(), test::Arm::Measure(unseen, 1.0, 64, 2)),
            {0}},
        explained(ExplainedOf(seen, arm.machine, run.seen, sd)),
        data{arm.machine, run, sd, explained.blocks, explained.steps},
        judgement(JudgeUnseen(data, explained, [] { return false; })) {}

  std::vector<std::string> NamesOf(const Model& model) const {
    std::vector<std::string> names;
    for (const Member& member : model) {
      names.push_back(explained.blocks[member.block].name);
    }
    return names;
  }
  DiscoveryVerdict Verdict() const {
    return VerdictOf(ShareLeft(data, judgement), !judgement.answer.fit.model.empty());
  }

  test::Arm arm;
  Eigen::VectorXd sd = Eigen::VectorXd::Constant(2, test::Arm::kNoise);
  SplitRun run;
  Explained explained;
  AnswerData data;
  UnseenJudgement judgement;
};

TEST(UnseenJudgement, KeepsWhatAnotherRecordShowsAsWell) {
  const Judged judged({kDamper}, {kDamper});
  EXPECT_THAT(judged.NamesOf(judged.judgement.answer.fit.model),
              ElementsAre("viscous_friction@elbow"));
  EXPECT_GT(judged.judgement.losses.front().unseen, 100.0);
  EXPECT_EQ(judged.Verdict(), DiscoveryVerdict::kExplained);
}

TEST(UnseenJudgement, LeavesOutAMemberThatAnotherRecordSpeaksAgainst) {
  const Judged judged({kDamper, kOther}, {kDamper});
  ASSERT_THAT(judged.NamesOf(judged.explained.fit.model),
              Contains("viscous_friction@shoulder"));
  const auto kept = judged.NamesOf(judged.judgement.answer.fit.model);
  EXPECT_THAT(kept, Contains("viscous_friction@elbow"));
  EXPECT_THAT(kept, Not(Contains("viscous_friction@shoulder")));
  EXPECT_FALSE(judged.judgement.decisions.empty());
}

TEST(UnseenJudgement, HasNoModelThatPredictsNoBetterThanThePlantAsGiven) {
  const Judged judged({kDamper}, {});
  ASSERT_FALSE(judged.explained.fit.model.empty());
  EXPECT_THAT(judged.judgement.answer.fit.model, IsEmpty());
  EXPECT_EQ(judged.Verdict(), DiscoveryVerdict::kUnexplained)
      << "what was fitted lacks something all the same";
}

TEST(UnseenJudgement, FindsNothingWhereNothingIsHidden) {
  const Judged judged({}, {});
  EXPECT_THAT(judged.judgement.answer.fit.model, IsEmpty());
  EXPECT_EQ(judged.Verdict(), DiscoveryVerdict::kNoDiscrepancy);
}

// Behind what it leaves a model may be likelier and yet lack more than the machine as given.
TEST(MissingShare, IsWorseWhereMoreIsMissingThanBesideTheMachineAsGiven) {
  EXPECT_TRUE((MissingShare{1.2, true, true}.IsWorse()));
  EXPECT_FALSE((MissingShare{0.9, true, true}.IsWorse()));
  EXPECT_FALSE((MissingShare{1.2, true, false}.IsWorse())) << "noise explains it";
}

TEST(LeaveNothing, GivesTheMachineAsGivenForAnAnswerAndSaysWhatWasRefuted) {
  Judged one({kDamper}, {kDamper});
  ASSERT_THAT(one.NamesOf(one.judgement.answer.fit.model), Not(IsEmpty()));
  LeaveNothing(one.explained.blocks, "why", 1.2, one.judgement);
  EXPECT_THAT(one.NamesOf(one.judgement.answer.fit.model), IsEmpty());
  EXPECT_EQ(one.judgement.answer.unseen_deviance,
            one.judgement.nothing.unseen_deviance);
  EXPECT_THAT(one.judgement.losses, IsEmpty());
  EXPECT_THAT(one.judgement.refuted,
              Contains(::testing::HasSubstr("viscous_friction@elbow")));
  EXPECT_EQ(one.judgement.decisions.back().why, "why");
}

}  // namespace
}  // namespace mjdiag
