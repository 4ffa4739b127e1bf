#include "mjdiag/studies/hidden_case.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/outside_law.h"
#include "mjdiag/studies/visible_size.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

/// With an encoder noise of a micrometre, one move of it.
Machine Emps() {
  return Machine(
      ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps",
                {"sensors.q.noise_power=1e-15", "trajectories.default.duration=2.5"}));
}

const Eigen::VectorXd& PositionsOf(const HiddenCase& hidden) {
  return hidden.measurements.fit.front().record.At("q").samples;
}

TEST(HiddenCase, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Machine model = Emps();
  const HiddenCase one = DrawHiddenCase(model, {.causes = 2}, 3);
  const HiddenCase again = DrawHiddenCase(model, {.causes = 2}, 3);
  const HiddenCase other = DrawHiddenCase(model, {.causes = 2}, 4);
  ASSERT_EQ(one.truth.size(), 2u);
  EXPECT_EQ(one.truth, again.truth);
  EXPECT_EQ(one.numbers, again.numbers);
  EXPECT_EQ(PositionsOf(one), PositionsOf(again));
  EXPECT_EQ(one.measurements.fit.size(), again.measurements.fit.size());
  EXPECT_NE(one.truth, other.truth);
  EXPECT_NE(one.numbers, other.numbers);
  EXPECT_NE(PositionsOf(one), PositionsOf(other));
}

TEST(HiddenCase, NumbersAreOffByAsMuchAsIsNotKnownOfThem) {
  const Machine model = Emps();
  Random random(1);
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 300; ++i) {
    for (const auto& [number, factor] : DrawNumbers(model.plant(), random)) {
      const double z = std::log(factor) / DoubtOf(model.plant(), number);
      sum += z;
      squares += z * z;
      ++count;
    }
  }
  EXPECT_EQ(count, 1200);  // mass, inertia, damping and gear
  EXPECT_NEAR(sum / count, 0.0, 0.1);
  EXPECT_NEAR(squares / count, 1.0, 0.15);
}

TEST(HiddenCase, IsMeasuredOnAnotherMachineThanTheModelThatIsGiven) {
  const Machine model = Emps();
  const HiddenCase hidden = DrawHiddenCase(model, {.causes = 0}, 1);
  EXPECT_TRUE(hidden.truth.empty());
  const Machine& given = hidden.measurements.fit.front().machine;
  EXPECT_EQ(given.plant().body_mass[1], model.plant().body_mass[1]);
  EXPECT_EQ(given.rates().substeps, model.rates().substeps);
  EXPECT_EQ(given.changes(), Changes{});
  // With the drawn numbers the model leaves what its longer steps and the noise are.
  const auto off = [&](const Machine& machine) {
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    const Record record =
        Simulate(machine, Replay(machine.setup(), hidden.unseen_clean), quiet);
    return (record.At("q").samples - hidden.unseen_clean.At("q").samples).norm();
  };
  EXPECT_GT(off(model), 20.0 * off(model.WithNumbers(hidden.numbers)));
  EXPECT_GT(off(model.WithNumbers(hidden.numbers)), 0.0);
}

TEST(HiddenCase, HidesALawThatIsInNoListInEveryFifth) {
  int outside = 0;
  std::array<int, 4> of_causes{};
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const HiddenPlan plan = PlanOf(seed);
    outside += plan.outside ? 1 : 0;
    if (!plan.outside) ++of_causes[static_cast<std::size_t>(plan.causes)];
  }
  EXPECT_EQ(outside, 400);
  EXPECT_NEAR(of_causes[1], 960, 80);
  EXPECT_NEAR(of_causes[2], 400, 60);
  EXPECT_NEAR(of_causes[3], 240, 50);
}

TEST(HiddenCase, HasAnOutsideLawOnADrivenJoint) {
  const HiddenCase hidden = DrawHiddenCase(Emps(), PlanOf(10), 10);
  ASSERT_EQ(hidden.truth.size(), 1u);
  EXPECT_EQ(hidden.outside_joint, 0);
  EXPECT_TRUE(std::ranges::any_of(OutsideLaws(), [&](const Effect* law) {
    return law == hidden.truth.front().effect.get();
  }));
}

TEST(HiddenCase, NeedsAMachineThatFollowsTrajectories) {
  const Machine open(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/voice_coil"));
  EXPECT_NE(test::MessageOf<InputError>([&] {
              DrawHiddenCase(open, {}, 1);
            }).find("has no controlled axes"),
            std::string::npos);
}

TEST(VisibleSize, IsWhatNoNumbersOfThePlantExplain) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const auto part = [&](const Cause& cause) {
    return visible.Shown(cause, visible.NoOthers()) /
           visible.Innovations(cause).squaredNorm();
  };
  // Damping may be another one by a factor of 2, ripple is in no number.
  EXPECT_LT(part(ParseEffect("viscous_friction@load:coefficient=1")), 0.01);
  EXPECT_GT(part(ParseEffect("force_ripple@load:amplitude=1,period=0.01")), 0.5);
}

// A stage that nothing holds follows a reading that drifts: damping makes a constant force
// of its speed.
TEST(VisibleSize, IsNothingBesideALawThatDoesTheSame) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const Cause drift = ParseEffect("encoder_drift@load_encoder:rate=2e-3");
  EXPECT_GT(visible.Shown(drift, visible.NoOthers()), kLeastShown);
  EXPECT_LT(visible.ShownBesideOtherLaws(drift), kLeastTold);
  const Cause ripple = ParseEffect("force_ripple@load:amplitude=10,period=0.01");
  EXPECT_GT(visible.ShownBesideOtherLaws(ripple), kLeastShown);
}

// A simulation with steps that are half as long is late, to first order, and nothing else.
TEST(VisibleSize, IsNotHiddenByStepsThatOnlyMakeInputsEarly) {
  const Machine model = Emps().WithSensorNoise(Eigen::VectorXd::Constant(1, 1e-8));
  const Cause cause = ParseEffect("coulomb_friction@load:force=2");
  const auto shown = [&](int substeps) {
    const VisibleSize visible(model, substeps, DefaultMotion(model.setup()));
    return visible.Shown(cause, visible.NoOthers());
  };
  const double same = shown(model.rates().substeps);
  EXPECT_NEAR(shown(2 * model.rates().substeps) / same, 1.0, 0.1);
}

TEST(VisibleSize, IsNothingBesideACauseThatDoesTheSame) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const Cause cause = ParseEffect("coulomb_friction@load:force=2");
  const Eigen::VectorXd one = visible.Innovations(cause);
  EXPECT_GT(visible.Shown(cause, visible.NoOthers()), 200.0);
  EXPECT_LT(visible.Shown(cause, 2.0 * one), 1e-6 * one.squaredNorm());
}

// A motor of half its force is a stage of twice its mass, damping and friction: as far as
// these may be off, and no further, whatever the first order says.
TEST(VisibleSize, OfAWeakMotorIsWhatWrongNumbersCost) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const Cause weak = ParseEffect("motor_constant@drive:factor=0.8");
  EXPECT_LT(visible.Shown(weak, visible.NoOthers()), 20.0);
}

TEST(VisibleSize, OfALawWithASimplerOneInItIsWhatTellsThemApart) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const auto told = [&](const char* law) {
    return visible.ShownBesideSimplerLaw(ParseEffect(law));
  };
  // What falls with speed far above all speeds does not fall.
  EXPECT_LT(told("stribeck_friction@load:coulomb=1,breakaway=1,velocity=9"), 20.0);
  EXPECT_GT(told("stribeck_friction@load:coulomb=1,breakaway=9,velocity=0.05"), 200.0);
}

TEST(VisibleSize, BesideOtherLawsIsWhatTellsACauseFromThemWithTheOthersThere) {
  const Machine model = Emps();
  const VisibleSize visible(model, model.rates().substeps,
                            DefaultMotion(model.setup()));
  const Cause ripple = ParseEffect("force_ripple@load:amplitude=10,period=0.01");
  const auto told = [&](const char* law) {
    return visible.ShownBesideOtherLaws({ripple, ParseEffect(law)}, 1);
  };
  EXPECT_LT(told("stribeck_friction@load:coulomb=2,breakaway=0.02,velocity=0.05"),
            kLeastTold);
  EXPECT_GT(told("stribeck_friction@load:coulomb=1,breakaway=9,velocity=0.05"),
            kLeastTold);
}

}  // namespace
}  // namespace mjdiag
