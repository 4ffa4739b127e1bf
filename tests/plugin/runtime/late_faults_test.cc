#include "mjdiag/plugin/runtime/late_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using testing::HasSubstr;

class LateFaults : public ::testing::TestWithParam<bool> {
 protected:
  Record Run(const Machine& machine, const RunOptions& options) const {
    return GetParam() ? SimulateLinear(machine, motion_, options)
                      : Simulate(machine, motion_, options);
  }
  static Excitation Short(const Machine& machine) {
    Trajectory trajectory = machine.setup().trajectories.Find("multi");
    trajectory.duration = 0.06;
    return FollowTrajectory(machine.setup(), trajectory);
  }

  const Machine bonder_ = test::Bonder();
  const Excitation motion_ = Short(bonder_);
};

INSTANTIATE_TEST_SUITE_P(Plants, LateFaults, ::testing::Bool(), [](const auto& plant) {
  return plant.param ? "linear" : "nonlinear";
});

TEST_P(LateFaults, FromTheStartAreThoseOfAFaultyMachineToTheLastBit) {
  RunOptions late;
  late.late_faults = {
      {{"eta_x", 0.7}, 0.0}, {{"beta_y", 0.5}, 0.0}, {{"gamma", 1.0}, 0.0}};
  RunOptions faulty;
  faulty.disturbances["gamma"] = 1.0;
  const Record a = Run(bonder_, late);
  const Record b = Run(bonder_.With({{{"eta_x", 0.7}, {"beta_y", 0.5}}, {}}), faulty);
  for (const char* channel : {"x", "y", "z", "u_x"}) {
    EXPECT_EQ(a.At(channel).samples, b.At(channel).samples) << channel;
  }
}

TEST_P(LateFaults, LeaveTheRunBeforeThemAsItWas) {
  const double time = 0.0125;
  const Eigen::Index tick = 100;
  const Record healthy = Run(bonder_, {});
  for (const Fault& fault : {Fault{"zeta_x", 2.0}, Fault{"gamma", 1.0}}) {
    RunOptions options;
    options.late_faults = {{fault, time}};
    const Record run = Run(bonder_, options);
    EXPECT_EQ(run.At("x").samples.head(tick + 1),
              healthy.At("x").samples.head(tick + 1));
    EXPECT_GT((run.At("x").samples - healthy.At("x").samples).tail(200).norm(), 1e-7);
  }
}

TEST_P(LateFaults, GoAsTheyCame) {
  RunOptions options;
  options.late_faults = {{{"eta_x", 1.0}, 0.03},
                         {{"eta_x", 0.7}, 0.03},
                         {{"eta_x", 0.7}, 0.01},
                         {{"eta_x", 1.0}, 0.031}};
  const std::vector<MachineStage> stages = StagesOf(bonder_, options.late_faults);
  ASSERT_EQ(stages.size(), 3u);
  EXPECT_EQ(stages[0].tick, 80);
  EXPECT_EQ(stages[1].tick, 240);
  EXPECT_EQ(stages[2].tick, 248);
  const auto gear = [](const Machine& machine) {
    return machine.plant().actuator_gear[0];
  };
  EXPECT_DOUBLE_EQ(gear(stages[0].machine), 0.7 * gear(bonder_));
  EXPECT_DOUBLE_EQ(gear(stages[1].machine), 0.7 * gear(bonder_));
  EXPECT_DOUBLE_EQ(gear(stages[2].machine), gear(bonder_));
  if (!GetParam()) return;  // dry friction does not forget that there were tones
  RunOptions tones;
  tones.late_faults = {{{"gamma", 1.0}, 0.01}, {{"gamma", 0.0}, 0.02}};
  const Record run = Run(bonder_, tones);
  const Record healthy = Run(bonder_, {});
  const auto off = [&](Eigen::Index from) {
    return (run.At("y").samples - healthy.At("y").samples).segment(from, 40).norm();
  };
  EXPECT_GT(off(120), 20.0 * off(440));
}

TEST(LateFault, GrowsEvenlyWhileOthersAppearAndGrow) {
  const Machine bonder = test::Bonder();
  const double tick = bonder.rates().tick();
  // eta_x falls to 0.6 within 80 ticks from 40 on, eta_y is 0.9 from 80 on, zeta_x is
  // doubled within 40 from 100 on.
  const std::array faults{LateFault{{"eta_x", 0.6}, 40 * tick, 80 * tick},
                          LateFault{{"eta_y", 0.9}, 80 * tick},
                          LateFault{{"zeta_x", 2.0}, 100 * tick, 40 * tick}};
  const auto gear_of = [&](const char* motor) {
    int at = 6 * mj_name2id(&bonder.plant(), mjOBJ_ACTUATOR, motor);
    while (bonder.plant().actuator_gear[at] == 0.0) ++at;
    return at;
  };
  const int motor_x = gear_of("x_motor");
  const int motor_y = gear_of("y_motor");
  const int guide =
      bonder.plant().jnt_dofadr[mj_name2id(&bonder.plant(), mjOBJ_JOINT, "X")];
  const ModelPtr now = CopyModel(bonder.plant());
  const auto share = [&](const mjtNum* of_now, const mjtNum* healthy, int i) {
    return of_now[i] / healthy[i];
  };
  const std::vector<MachineStage> stages = StagesOf(bonder, faults);
  auto stage = stages.begin();
  Eigen::Index left = 0;
  const MachineStage* growing = nullptr;
  for (Eigen::Index k = 0; k < 160; ++k) {
    for (; stage != stages.end() && stage->tick <= k; ++stage) {
      if (stage->ticks == 0) CopyFaults(stage->machine.plant(), *now);
      left = stage->ticks;
      growing = &*stage;
    }
    const auto done = [&](Eigen::Index from, Eigen::Index ticks) {
      return std::clamp(static_cast<double>(k - from) / static_cast<double>(ticks), 0.0,
                        1.0);
    };
    EXPECT_NEAR(share(now->actuator_gear, bonder.plant().actuator_gear, motor_x),
                1.0 - 0.4 * done(40, 80), 1e-12)
        << k;
    EXPECT_NEAR(share(now->actuator_gear, bonder.plant().actuator_gear, motor_y),
                k < 80 ? 1.0 : 0.9, 1e-12)
        << k;
    EXPECT_NEAR(share(now->dof_damping, bonder.plant().dof_damping, guide),
                1.0 + done(100, 40), 1e-12)
        << k;
    if (left > 0) {
      ApproachFaults(growing->machine.plant(), 1.0 / static_cast<double>(left), *now);
      --left;
    }
  }
}

TEST(LateFault, ThatMakesNoSenseIsRefused) {
  const Machine bonder = test::Bonder();
  const auto message = [&](const LateFault& fault) {
    return test::MessageOf<InputError>([&] { StagesOf(bonder, std::array{fault}); });
  };
  EXPECT_THAT(message({{"eta_q", 1.0}, 0.0}), HasSubstr("eta_q"));
  EXPECT_THAT(message({{"eta_x", -1.0}, 0.0}), HasSubstr("out of range"));
  EXPECT_THAT(message({{"eta_x", 0.7}, -1.0}), HasSubstr("no time of the run"));
  EXPECT_THAT(message({{"eta_x", 0.7}, 0.0, -1.0}), HasSubstr("grows in no time"));
  EXPECT_THAT(message({{"gamma", 1.0}, 0.0, 1.0}), HasSubstr("appears at once"));
  const std::array dead{LateFault{{"eta_x", 0.0}, 0.0}, LateFault{{"eta_x", 1.0}, 1.0}};
  EXPECT_THAT(test::MessageOf<InputError>([&] { StagesOf(bonder, dead); }),
              HasSubstr("is 0 and cannot become anything else"));
}

}  // namespace
}  // namespace mjdiag
