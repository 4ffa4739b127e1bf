#include "mjdiag/discovery/fit/model_fit.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "support/arm.h"
#include "support/member_of.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

class FitModelTo : public ::testing::Test {
 protected:
  Model Of(const std::string& name, const VectorXd& values) const {
    return {test::MemberOf(blocks_, name, values)};
  }
  /// From a model on; how many machines were asked for is left in `machines_`.
  ModelFit Fitted(const Model& start, const FitEffort& effort) {
    machines_ = 0;
    const auto machine_with = [&](const Model& model) {
      ++machines_;
      return arm_.machine.With(ChangesOfModel(blocks_, model));
    };
    return FitModel(machine_with, run_, path_, gains_, blocks_, start, effort);
  }

  test::Arm arm_;
  MeasuredRun run_ = ToMeasuredRun(
      arm_.setup(),
      test::Arm::Measure({"viscous_friction@elbow:coefficient=0.05"}, 1.0, 2));
  FilterPath path_ =
      FilterLikeliest(arm_.machine, run_, VectorXd::Constant(2, test::Arm::kNoise));
  KeptGains gains_ = KeepGains(path_);
  std::vector<Block> blocks_ = BlocksOf(arm_.machine, ListCandidates(arm_.machine), {});
  int machines_ = 0;
};

TEST_F(FitModelTo, LeavesValuesWhereAStepPromisesLessThanIsAskedFor) {
  const Model start = Of("viscous_friction@elbow", VectorXd::Constant(1, 0.01));
  const double all = Fitted(start, {}).deviance - Fitted(start, {4}).deviance;
  ASSERT_GT(all, 10.0);
  EXPECT_EQ(Fitted(start, {4, 100.0 * all}).model[0].values, start[0].values);
  EXPECT_NE(Fitted(start, {4, 0.1 * all}).model[0].values, start[0].values);
}

// A spring that gives way has to become next to nothing on the way to a damper.
TEST_F(FitModelTo, EndsAfterThreeStepsWhereNothingHelps) {
  const Model start = Of("presliding_hysteresis@elbow", Eigen::Vector2d(0.3, 0.5));
  Fitted(start, {6});
  const int whole = machines_;
  const ModelFit cut = Fitted(start, {.iterations = 6, .hopeless = 0.0});
  EXPECT_LT(machines_, whole);
  EXPECT_NE(cut.model[0].values, start[0].values);
}

}  // namespace
}  // namespace mjdiag
