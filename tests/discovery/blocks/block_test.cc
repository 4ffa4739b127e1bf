// Blocks: what a machine may lack, and which values of it there may be.

#include "mjdiag/discovery/blocks/block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/discovery/hypotheses/candidate_choice.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/structure/force_curve.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

// What is known to a tenth may be off by nine of them.
TEST(Block, KnowsANumberAtTheEndOfWhatIsKnown) {
  Block mass;
  mass.name = "mass@arm";
  mass.doubt = 0.1;
  for (const double sign : {-1.0, 1.0}) {
    const auto at = [&](double logarithm) {
      return Eigen::VectorXd::Constant(1, std::exp(sign * logarithm)).eval();
    };
    EXPECT_FALSE(HasActiveBound(mass, at(0.89)));
    EXPECT_TRUE(HasActiveBound(mass, at(kFarthest * 0.1)));
    EXPECT_TRUE(IsAllowed(mass, at(kFarthest * 0.1)));
    EXPECT_FALSE(IsAllowed(mass, at(0.91)));
  }
}

// Laws are taken in the place of others before anything has looked at their own shapes: one that
// costs nothing would be in the place of any that says as much.
TEST(Block, CostsSomethingBeforeItIsLookedAt) {
  const test::Stage stage;
  const std::vector<Block> blocks =
      BlocksOf(stage.machine, ChooseCandidates(stage.machine, {}, true),
               NumbersOf(stage.machine.plant()));
  ASSERT_FALSE(blocks.empty());
  for (const Block& block : blocks) EXPECT_GE(block.price, kClaim) << block.name;
}

/// A curve over a position of 0 to 1, forces over the spread.
Block CurveOfKnots(int knots) {
  Candidate curve{.effect = Lasting(ForceCurve()), .site = "j", .parameters = {}};
  curve.chosen = Eigen::VectorXd::Zero(force_curve::kFirst);
  curve.chosen[force_curve::kWidth] = 1.0;
  curve.chosen[force_curve::kShape] = static_cast<double>(CurveShapes::kPlain);
  curve.chosen[force_curve::kKnots] = knots;
  for (int i = 0; i < knots; ++i) {
    curve.parameters.push_back({"force", Role::kAmplitude, -10.0, 10.0, 0.0, 1.0});
  }
  Block block;
  block.candidate = curve;
  return block;
}

TEST(Block, CostsOfACurveWhatTheFunctionDoesThatItsKnotsDescribe) {
  const auto price = [](int knots, const auto& force) {
    const Eigen::VectorXd values =
        Eigen::VectorXd::NullaryExpr(knots, [&](Eigen::Index i) {
          return force(static_cast<double>(i) / static_cast<double>(knots - 1));
        });
    return SizePrice(CurveOfKnots(knots), values);
  };
  const auto square = [](double x) { return x * x; };
  // Knots in between say nothing new: less than one unit each.
  EXPECT_LT(price(17, square), price(9, square) + 8.0);
  // One that is off by a spread is another function.
  const auto kinked = [&](double x) { return square(x) + (x == 0.5 ? 1.0 : 0.0); };
  EXPECT_GT(price(17, kinked), price(17, square) + 30.0);
}

}  // namespace
}  // namespace mjdiag
