#include "mjdiag/discovery/hypotheses/candidate_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "discovery/stage_motion.h"
#include "mjdiag/plugin/effects/effect.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

const FitParameter& Parameter(const std::vector<Candidate>& candidates,
                              const std::string& candidate, const std::string& name) {
  const auto found = std::ranges::find(
      candidates, candidate, [](const Candidate& c) { return CandidateName(c); });
  return *std::ranges::find(found->parameters, name, &FitParameter::name);
}

TEST(BoundByRecord, KeepsShapesWithinWhatTheMotionReaches) {
  const test::Stage stage;
  auto candidates = ListCandidates(stage.machine);
  const auto before = candidates;
  const ObservedMotion motion = test::MotionOf(stage);
  BoundByRecord(candidates, stage.machine, motion);
  const double speed = motion.velocity.cwiseAbs().maxCoeff();
  const FitParameter& velocity =
      Parameter(candidates, "stribeck_friction@load", "velocity");
  EXPECT_DOUBLE_EQ(velocity.lower, 1e-3 * speed);
  EXPECT_DOUBLE_EQ(velocity.upper, 2.0 * speed);
  EXPECT_DOUBLE_EQ(Parameter(candidates, "force_saturation@drive", "limit").upper,
                   motion.inputs.cwiseAbs().maxCoeff());
  EXPECT_DOUBLE_EQ(Parameter(candidates, "end_stop@load", "position").lower,
                   motion.position.minCoeff());
  // A size is no shape.
  EXPECT_EQ(Parameter(candidates, "coulomb_friction@load", "force").upper,
            Parameter(before, "coulomb_friction@load", "force").upper);
}

// Goes of 10 mm each, 50 mm apart: a wave of 5 mm is seen to come round, and one of 200 mm from
// one go to the next; one of 50 mm looks the same at every go.
TEST(BoundByRecord, LeavesNoPeriodsThatGapsBetweenRecordsMakeUp) {
  const test::Stage stage;
  auto candidates = ListCandidates(stage.machine);
  ObservedMotion motion = test::MotionOf(stage);
  const Eigen::Index each = motion.samples() / 5;
  for (Eigen::Index k = 0; k < motion.samples(); ++k) {
    const Eigen::Index go = std::min<Eigen::Index>(4, k / each);
    const double way = static_cast<double>(k - go * each) / static_cast<double>(each);
    motion.time[k] = way;
    motion.position(0, k) = 0.05 * static_cast<double>(go) + 0.01 * std::min(1.0, way);
  }
  BoundByRecord(candidates, stage.machine, motion);
  const FitParameter& period = Parameter(candidates, "force_ripple@load", "period");
  EXPECT_TRUE(period.IsSeen(0.005));
  EXPECT_TRUE(period.IsSeen(0.2));
  EXPECT_FALSE(period.IsSeen(0.05));
  EXPECT_GE(period.upper, 0.2);
}

// An encoder of 1 um says nothing of waves that repeat with it, or are smaller than half.
TEST(BoundByReadings, LeavesNoErrorsBelowTheStepOfAnEncoder) {
  const test::Stage stage;
  auto candidates = ListCandidates(stage.machine);
  MeasuredRun run = ToMeasuredRun(stage.machine.setup(), stage.Measure({}));
  constexpr double kStep = 1e-6;
  run.outputs = (run.outputs / kStep).array().round() * kStep;
  BoundByReadings(candidates, stage.machine, run);
  const auto wave = std::ranges::find_if(candidates, [](const Candidate& candidate) {
    return candidate.effect->name() == "encoder_periodic_error";
  });
  ASSERT_NE(wave, candidates.end());
  const std::string name = CandidateName(*wave);
  EXPECT_NEAR(Parameter(candidates, name, "period").lower, 4.0 * kStep, 1e-3 * kStep);
  EXPECT_NEAR(Parameter(candidates, name, "amplitude").least_size, 0.5 * kStep,
              1e-3 * kStep);
}

TEST(BoundSprings, LeavesNoWindupThatATickHides) {
  const test::Stage stage;
  auto candidates = ListCandidates(stage.machine);
  BoundSprings(candidates, stage.machine, 1e-3);
  EXPECT_DOUBLE_EQ(
      Parameter(candidates, "transmission_windup@load_encoder", "compliance")
          .least_size,
      0.5e-6 / stage.machine.mechanics().M(0, 0));
}

// Encoders of 20 nm see no play that is less, and none in a mount that moves no further.
TEST(BoundPlays, LeavesNoneThatNoReadingWouldSee) {
  const Machine bonder = test::Bonder();
  const auto with_stroke = [&](double stroke) {
    auto candidates = ListCandidates(bonder);
    for (Candidate& one : candidates) {
      if (CandidateName(one) == "backlash@u3") one.parameters[0].upper = stroke;
    }
    BoundPlays(candidates, bonder, Eigen::VectorXd::Constant(3, 2e-8));
    return candidates;
  };
  EXPECT_EQ(Parameter(with_stroke(1e-6), "backlash@u3", "gap").lower, 2e-8);
  EXPECT_EQ(std::ranges::count(with_stroke(1e-8), std::string("backlash@u3"),
                               [](const Candidate& one) { return CandidateName(one); }),
            0);
}

TEST(ListCandidates, EndWhereALawBecomesOtherPhysics) {
  const test::Stage stage;
  const auto candidates = ListCandidates(stage.machine);
  EXPECT_EQ(Parameter(candidates, "flexible_mode@load", "damping_ratio").upper, 0.3);
  // Simulated it may be more.
  EXPECT_EQ(ParseEffect("flexible_mode@load:mass=1,frequency=20,damping_ratio=0.9")
                .Value("damping_ratio"),
            0.9);
}

}  // namespace
}  // namespace mjdiag
