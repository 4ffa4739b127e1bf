#include "mjdiag/studies/outside_law.h"

#include <gtest/gtest.h>

#include <set>

#include "mjdiag/discovery/hypotheses/cause.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

TEST(OutsideLaws, AreInNoListOfTheEngine) {
  std::set<std::string> names;
  for (const Effect* law : OutsideLaws()) {
    names.insert(law->name());
    EXPECT_THROW(FindEffect(law->name()), InputError) << law->name();
    for (const Effect* known : Effects()) EXPECT_NE(known, law);
  }
  EXPECT_EQ(names.size(), 7u);
}

class OutsideLaw : public ::testing::TestWithParam<const Effect*> {};

// Of all axes, at the size that a benchmark draws at most.
TEST_P(OutsideLaw, MovesTheMachineByMoreThanNoise) {
  const Effect& law = *GetParam();
  const Machine machine = test::Bonder({"trajectories.xyz.duration=0.1"});
  const mjdiag::Setup& setup = machine.setup();
  const Excitation motion = FollowTrajectory(setup, setup.trajectories.Find("xyz"));
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Record healthy = Simulate(machine, motion, quiet);
  const SiteMap map(machine.plant(), machine.linear(), machine.channels());
  const std::vector<Site> sites = law.CandidateSites(map);
  ASSERT_FALSE(sites.empty());
  Scales scales{.stroke = 0.004, .speed = 0.4, .force = 100.0, .mass = 3.0};
  Random random(1);
  const Cause cause{Lasting(law), sites.front().name, law.Draw(scales, random)(1.0)};
  const Record changed = Simulate(machine.With({{}, {cause}}), motion, quiet);
  double most = 0.0;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    const Eigen::VectorXd off =
        changed.At(sensor.channel).samples - healthy.At(sensor.channel).samples;
    most = std::max(most, off.cwiseAbs().maxCoeff() / sensor.noise_sd);
  }
  EXPECT_GT(most, 20.0) << CauseWithValues(cause);
}

INSTANTIATE_TEST_SUITE_P(All, OutsideLaw, ::testing::ValuesIn(OutsideLaws()),
                         [](const auto& param) { return param.param->name(); });

double ForceOf(const Effect& law, double q, double v, const EffectValues& values) {
  return dynamic_cast<const JointForceEffect&>(law).Force(q, v, 0.0, values);
}

TEST(RootFriction, DoublesWhereTheSpeedIsFourTimesThat) {
  const EffectValues values = ValuesOf({3.0, 0.4});
  EXPECT_NEAR(ForceOf(RootFriction(), 0.0, 0.4, values), -3.0, 1e-5);
  EXPECT_NEAR(ForceOf(RootFriction(), 0.0, -0.1, values), 1.5, 1e-4);
}

TEST(SpeedSoftening, HalvesASpringAtItsVelocity) {
  const EffectValues values = ValuesOf({100.0, 0.2});
  EXPECT_DOUBLE_EQ(ForceOf(SpeedSoftening(), 0.01, 0.0, values), -1.0);
  EXPECT_DOUBLE_EQ(ForceOf(SpeedSoftening(), 0.01, -0.2, values), -0.5);
}

TEST(PeriodicDamping, NeverDrives) {
  const EffectValues values = ValuesOf({10.0, 0.4, 0.001, 0.0006});
  for (double q = -0.01; q < 0.01; q += 1e-4) {
    EXPECT_LE(ForceOf(PeriodicDamping(), q, 0.3, values), 0.0) << q;
  }
}

}  // namespace
}  // namespace mjdiag
