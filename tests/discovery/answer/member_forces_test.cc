#include "mjdiag/discovery/answer/member_forces.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "support/member_of.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

class MemberForces : public ::testing::Test {
 protected:
  Member Of(const std::string& name, const VectorXd& values) const {
    return test::MemberOf(blocks_, name, values);
  }
  std::vector<bool> Missed(const Model& model, PhysicsSteps steps = {}) const {
    const SplitRun split{run_, run_, {0}, 1.0};
    const AnswerData data{stage_.machine, split, noise_, blocks_, steps};
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
  EXPECT_EQ(Missed({friction, ripple(0.1)}, {1.0}), (std::vector<bool>{false, true}));
  EXPECT_EQ(Missed({friction, ripple(1.5)}, {1.0}), (std::vector<bool>{false, false}));
}

// The error that makes up for an inertia that is off by 1e-7 is hidden by the readings' noise;
// one that a single reading shows is not, however slow it is, nor one in which there are jolts.
TEST_F(MemberForces, OfReadingsAreMissedWhereOneReadingShowsThem) {
  const Member friction = Of("coulomb_friction@load", VectorXd::Constant(1, 18.0));
  const auto scale = [&](double factor) {
    return Of("encoder_scale@load_encoder", VectorXd::Constant(1, factor));
  };
  const auto drift = [&](double rate) {
    return Of("encoder_drift@load_encoder", VectorXd::Constant(1, rate));
  };
  const Member fine_wave = Of("encoder_periodic_error@load_encoder",
                              Eigen::Vector3d(4.0 * noise_[0], 1e-4, 0.7));
  EXPECT_EQ(Missed({friction, fine_wave}), (std::vector<bool>{false, false}));
  const double seconds = run_.sample_time * static_cast<double>(run_.samples());
  EXPECT_EQ(Missed({friction, scale(1.0 + 1e-7)}), (std::vector<bool>{false, true}));
  EXPECT_EQ(Missed({friction, scale(1.01)}), (std::vector<bool>{false, false}));
  EXPECT_EQ(Missed({friction, drift(0.1 * noise_[0] / seconds)}),
            (std::vector<bool>{false, true}));
  EXPECT_EQ(Missed({friction, drift(20.0 * noise_[0] / seconds)}),
            (std::vector<bool>{false, false}));
}

// Steps that are not known may be half a step late: a delay of a hundredth of one is nothing.
TEST_F(MemberForces, BelowWhatUnknownStepsHideAreNotMissed) {
  const double step = stage_.machine.plant().opt.timestep;
  const auto delay = [&](double steps) {
    return Model{Of("input_delay@drive", VectorXd::Constant(1, steps * step))};
  };
  EXPECT_EQ(Missed(delay(0.01), {1.0}), std::vector<bool>{true});
  EXPECT_EQ(Missed(delay(0.01)), std::vector<bool>{false});
  EXPECT_EQ(Missed(delay(2.0), {1.0}), std::vector<bool>{false});
}

}  // namespace
}  // namespace mjdiag
