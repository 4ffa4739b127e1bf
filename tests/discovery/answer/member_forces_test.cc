#include "mjdiag/discovery/answer/member_forces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

class MemberForces : public ::testing::Test {
 protected:
  Member Of(const std::string& name, const VectorXd& values) const {
    const auto found = std::ranges::find(blocks_, name, &Block::name);
    return {static_cast<std::size_t>(found - blocks_.begin()), values};
  }
  std::vector<bool> Missed(const Model& model) const {
    const SplitRun split{run_, run_, {0}, 1.0};
    const AnswerData data{stage_.machine, split, noise_, blocks_, {1.0}};
    ModelOnRuns answer;
    answer.fit.model = model;
    answer.seen = FilterLikeliest(data.With(model), run_, noise_);
    return NobodyWouldMiss(data, answer);
  }

  test::Stage stage_;
  MeasuredRun run_ = ToMeasuredRun(stage_.setup(), stage_.Measure({}));
  VectorXd noise_ = SensorNoise(stage_.machine.channels(), run_);
  std::vector<Block> blocks_ =
      BlocksOf(stage_.machine, ListCandidates(stage_.machine), {});
};

// Friction of 18 N where the stage sticks is no more than 18 N.
TEST_F(MemberForces, AreMissedFromAHundredthOfAllOn) {
  const Member friction = Of("coulomb_friction@load", VectorXd::Constant(1, 18.0));
  const auto ripple = [&](double amplitude) {
    return Of("force_ripple@load", Eigen::Vector3d(amplitude, 0.02, 0.7));
  };
  EXPECT_EQ(Missed({friction, ripple(0.1)}), (std::vector<bool>{false, true}));
  EXPECT_EQ(Missed({friction, ripple(1.5)}), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace mjdiag
