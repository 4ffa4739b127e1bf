#include "mjdiag/discovery/answer/values_that_predict.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"
#include "support/member_of.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

bool IsOver() { return false; }

/// An arm with viscous friction of 0.05 N m s/rad at its elbow, two runs of it in the steps of its
/// model.
class ValuesThatPredict : public ::testing::Test {
 protected:
  static constexpr double kFriction = 0.05;
  static constexpr const char* kDamper = "viscous_friction@elbow:coefficient=0.05";

  MeasuredRun Measured(std::uint64_t seed) const {
    return ToMeasuredRun(arm_.setup(), test::Arm::Measure({kDamper}, 1.0, 2, seed));
  }
  std::optional<BetterValues> BetterThan(double friction) const {
    const AnswerData data{arm_.machine, run_, sd_, blocks_};
    ModelOnRuns answer;
    answer.fit.model = {test::MemberOf(blocks_, "viscous_friction@elbow",
                                       VectorXd::Constant(1, friction))};
    const Machine machine = data.With(answer.fit.model);
    answer.seen = FilterLikeliest(machine, run_.seen, sd_);
    answer.unseen = FilterLikeliest(machine, run_.unseen, sd_);
    return WithValuesThatPredict(data, answer, answer.seen.noise, IsOver);
  }

  test::Arm arm_;
  VectorXd sd_ = VectorXd::Constant(2, test::Arm::kNoise);
  SplitRun run_{Measured(1), Measured(2), {0}, 1.0};
  // Sized for this run.
  std::vector<Block> blocks_ =
      Explain(arm_.machine, run_.seen, sd_, {.seconds = 10.0}).blocks;
};

TEST_F(ValuesThatPredict, TakeThePlaceOfThoseThatDoNot) {
  const auto better = BetterThan(0.3 * kFriction);
  ASSERT_TRUE(better);
  EXPECT_LT(better->log_ratio, -1.0);
  EXPECT_NEAR(better->answer.fit.model.front().values[0], kFriction, 0.02 * kFriction);
}

TEST_F(ValuesThatPredict, AreNoOthersWhereNothingIsMissing) {
  EXPECT_FALSE(BetterThan(kFriction));
}

}  // namespace
}  // namespace mjdiag
