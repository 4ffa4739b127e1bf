// Models that moves make of one.

#include "mjdiag/discovery/fit/moved_model.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/effects/registry.h"

namespace mjdiag {
namespace {

Block FrictionBlock(const std::string& name) {
  Candidate candidate{
      .effect = Lasting(FindEffect(name)), .site = "j", .parameters = {}};
  for (const EffectParameter& one : candidate.effect->parameters()) {
    FitParameter parameter{one.name, one.role, one.minimum, one.maximum};
    if (one.role == Role::kVelocity) parameter.upper = 4.0;  // twice the fastest speed
    candidate.parameters.push_back(parameter);
  }
  Block block;
  block.name = name + "@j";
  block.candidate = candidate;
  block.group = "friction@j";
  return block;
}

const std::vector<Block> kFriction{
    FrictionBlock("viscous_friction"), FrictionBlock("coulomb_friction"),
    FrictionBlock("smooth_coulomb_friction"), FrictionBlock("yielding_friction")};

TEST(MovedModel, LetsDryFrictionCreepWithinATenthOfTheFastestSpeed) {
  const Model creeps = Creeping(kFriction, {{1, Eigen::VectorXd::Constant(1, 0.7)}});
  ASSERT_EQ(creeps.size(), 1u);
  EXPECT_EQ(creeps[0].block, 2u);
  EXPECT_EQ(creeps[0].values, Eigen::Vector2d(0.7, 0.2));
}

TEST(MovedModel, LetsDryFrictionThatCreepsBeThereAtOnce) {
  const Model abrupt = Abrupt(kFriction, {{2, Eigen::Vector2d(0.7, 0.2)}});
  ASSERT_EQ(abrupt.size(), 1u);
  EXPECT_EQ(abrupt[0].block, 1u);
  EXPECT_EQ(abrupt[0].values, Eigen::VectorXd::Constant(1, 0.7));
}

TEST(MovedModel, LetsJointsThatStandGiveWayAndHold) {
  const Eigen::VectorXd size = Eigen::VectorXd::Constant(1, 0.7);
  for (const Model& holds : {Model{{1, size}}, Model{{2, Eigen::Vector2d(0.7, 0.2)}}}) {
    const Model gives = GivingWay(kFriction, holds);
    EXPECT_EQ(gives[0].block, 3u);
    EXPECT_EQ(gives[0].values, size);
  }
  EXPECT_EQ(Abrupt(kFriction, {{3, size}})[0].block, 1u);
}

// Of a servo a limit of the drive was left for a gain that was worth a thirtieth more, until its
// friction was of the same form.
TEST(MovedModel, TakesFormsOfFrictionFromAnotherModelOfTheSameJoint) {
  std::vector<Block> blocks = kFriction;
  blocks.push_back(FrictionBlock("yielding_friction"));
  for (Block& one : blocks) one.resists = "j";
  blocks.back().resists = "k";
  const Eigen::VectorXd damps = Eigen::VectorXd::Constant(1, 0.1);
  const Model model{{0, damps}, {2, Eigen::Vector2d(0.7, 0.2)}};
  const Eigen::VectorXd size = Eigen::VectorXd::Constant(1, 0.5);
  const Model same_joint = InFormsOf(blocks, model, {{3, size}});
  ASSERT_EQ(same_joint.size(), 2u);
  EXPECT_EQ(same_joint[0].block, 0u);
  ASSERT_EQ(same_joint[1].block, 3u);
  EXPECT_EQ(same_joint[1].values, size);
  EXPECT_EQ(InFormsOf(blocks, model, {{4, size}})[1].block, 2u);
}

TEST(MovedModel, LeavesWhatIsNoDryFriction) {
  const Model damps{{0, Eigen::VectorXd::Constant(1, 0.7)}};
  for (const Model& other : {Creeping(kFriction, damps), Abrupt(kFriction, damps),
                             GivingWay(kFriction, damps)}) {
    ASSERT_EQ(other.size(), 1u);
    EXPECT_EQ(other[0].block, 0u);
  }
}

ModelMove Bringing(const std::vector<std::size_t>& blocks, double score) {
  ModelMove move;
  for (const std::size_t block : blocks) {
    Added added;
    added.variation.block = block;
    move.added.push_back(added);
  }
  move.score = score;
  return move;
}

/// What the moves bring that are fitted, of those that are better than a model of score 0.
std::vector<std::vector<std::size_t>> Fitted(std::vector<ModelMove> best) {
  Moves moves;
  moves.best = std::move(best);
  std::vector<std::vector<std::size_t>> fitted;
  for (const ModelMove* move :
       ToBeFitted(moves, 4, [](const ModelMove&) { return true; })) {
    fitted.emplace_back();
    for (const Added& added : move->added) {
      fitted.back().push_back(added.variation.block);
    }
  }
  return fitted;
}

using Blocks = std::vector<std::vector<std::size_t>>;

TEST(MovesToBeFitted, DoNotDoAllThatABetterOneDoesAndMore) {
  EXPECT_EQ(
      Fitted({Bringing({1}, -100.0), Bringing({1, 2}, -90.0), Bringing({3}, -80.0)}),
      (Blocks{{1}, {3}}));
}

TEST(MovesToBeFitted, AreTheSimplerOnesWhereMoreGainsNextToNothing) {
  EXPECT_EQ(Fitted({Bringing({1, 2}, -102.0), Bringing({1}, -100.0)}), (Blocks{{1}}));
  EXPECT_EQ(Fitted({Bringing({1, 2}, -150.0), Bringing({1}, -100.0)}),
            (Blocks{{1, 2}, {1}}));
}

}  // namespace
}  // namespace mjdiag
