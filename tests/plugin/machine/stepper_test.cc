#include "mjdiag/plugin/machine/stepper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/any_machine.h"
#include "support/bonder.h"
#include "support/changes.h"
#include "support/count_allocations.h"
#include "support/every_effect.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Pulls every axis to zero and shakes it.
class Shaker final : public TickControl {
 public:
  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      inputs[i] = amplitude * std::sin(0.05 * (ticks + 1)) - 100.0 * outputs[i];
    }
    std::copy(outputs.begin(), outputs.end(), seen.begin());
    std::copy(inputs.begin(), inputs.end(), held.begin());
    ++ticks;
  }
  double amplitude = 1.0;
  int ticks = 0;
  std::vector<double> seen = std::vector<double>(3);
  std::vector<double> held = std::vector<double>(3);
};

/// Another control callback while it is alive.
class ControlCallback {
 public:
  explicit ControlCallback(mjfGeneric callback) : before_(mjcb_control) {
    mjcb_control = callback;
  }
  ~ControlCallback() { mjcb_control = before_; }
  ControlCallback(const ControlCallback&) = delete;
  ControlCallback& operator=(const ControlCallback&) = delete;

 private:
  mjfGeneric before_;
};

// What the callback below works on.
Stepper* called_stepper = nullptr;
Shaker* called_control = nullptr;

void ExpectTheStepsOfMjStep(const Machine& machine) {
  constexpr int kTicks = 200;
  const StartedPlant one = StartPlant(machine, {});
  const StartedPlant other = StartPlant(machine, {});
  Shaker advanced;
  advanced.amplitude = 50.0;
  Stepper stepper(machine);
  {
    const ControlCallback none(nullptr);
    for (int k = 0; k < kTicks; ++k) stepper.Advance(*one.model, *one.data, advanced);
  }
  Shaker called;
  called.amplitude = advanced.amplitude;
  Stepper in_callback(machine);
  called_stepper = &in_callback;
  called_control = &called;
  {
    const ControlCallback callback([](const mjModel* model, mjData* data) {
      called_stepper->OnStep(*model, *data, *called_control);
    });
    for (int i = 0; i < kTicks * machine.rates().substeps; ++i) {
      mj_step(other.model.get(), other.data.get());
    }
  }
  EXPECT_EQ(called.ticks, kTicks);
  EXPECT_EQ(advanced.ticks, kTicks);
  EXPECT_EQ(advanced.seen, called.seen);
  for (int i = 0; i < one.model->nv; ++i) {
    EXPECT_EQ(one.data->qpos[i], other.data->qpos[i]) << i;
    EXPECT_EQ(one.data->qvel[i], other.data->qvel[i]) << i;
  }
  const double moved =
      VectorXd::Map(one.data->qpos, one.model->nv).cwiseAbs().maxCoeff();
  EXPECT_GT(moved, 1e-6) << "does not move";
}

TEST(Stepper, TakesTheStepsOfMjStepWithAControlCallbackToTheBit) {
  ExpectTheStepsOfMjStep(test::Bonder().With(test::With(
      {"coulomb_friction@X:force=1.3", "force_ripple@Y:amplitude=0.7,period=1e-4",
       "presliding_hysteresis@Y:force=1.1,stiffness=230000",
       "input_delay@x_motor:delay=2e-4",
       "encoder_periodic_error@y_encoder:amplitude=3e-8,period=2e-5"})));
}

// MuJoCo calls the callback at each of the four stages: controls of a tick, and forces of
// effects of a step, hold in all of them.
TEST(Stepper, TakesTheRungeKuttaStepsOfMjStep) {
  ExpectTheStepsOfMjStep(test::MachineOf(test::kRungeKutta)
                             .With(test::With({"coulomb_friction@j:force=0.3",
                                               "quadratic_drag@j:coefficient=2"})));
}

/// A stage of one axis with something in it, that moves at a quarter of a metre a
/// second.
struct MovingStage {
  explicit MovingStage(const std::string& effect)
      : machine(test::Stage().machine.With(test::With({effect}))),
        plant(StartPlant(machine, {})),
        stepper(machine) {
    plant.data->qvel[0] = 0.25;
  }
  void Advance(const std::function<void()>& after_step = {}) {
    stepper.Advance(*plant.model, *plant.data, control, after_step);
  }

  Machine machine;
  StartedPlant plant;
  Stepper stepper;
  Shaker control;
};

TEST(Stepper, LetsEffectsActInEveryStepFromTheVelocityOfThatStep) {
  MovingStage stage("quadratic_drag@load:coefficient=1000");
  double velocity = stage.plant.data->qvel[0];
  std::vector<double> forces;
  for (int k = 0; k < 3; ++k) {
    stage.Advance([&] {
      EXPECT_DOUBLE_EQ(stage.plant.data->qfrc_applied[0],
                       -1000.0 * velocity * std::abs(velocity));
      forces.push_back(stage.plant.data->qfrc_applied[0]);
      velocity = stage.plant.data->qvel[0];
    });
  }
  ASSERT_EQ(forces.size(), 6u);
  std::ranges::sort(forces);
  EXPECT_EQ(std::ranges::adjacent_find(forces), forces.end());
}

TEST(Stepper, ReadsTheSensorsAtTheStartOfATickAndHoldsTheInputsToItsEnd) {
  MovingStage stage("force_offset@load:force=1");
  const mjData& data = *stage.plant.data;
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(stage.stepper.AtTickStart());
    const double position = data.qpos[0];
    int steps = 0;
    stage.Advance([&] {
      ++steps;
      EXPECT_EQ(stage.stepper.AtTickStart(), steps == 2);
      EXPECT_EQ(stage.control.seen[0], position);
      EXPECT_EQ(data.ctrl[0], stage.control.held[0]);
    });
    EXPECT_EQ(steps, 2);
    EXPECT_EQ(stage.control.ticks, k + 1);
    EXPECT_NE(data.qpos[0], position);
  }
}

// 1 um/s is added to the reading of a sensor that drifts, from the first tick on.
TEST(Stepper, CountsTheTimeOfEncoderErrorsInTicks) {
  MovingStage stage("encoder_drift@load_encoder:rate=1e-6");
  for (int k = 0; k < 4; ++k) {
    const double position = stage.plant.data->qpos[0];
    stage.Advance();
    EXPECT_DOUBLE_EQ(stage.control.seen[0],
                     position + 1e-6 * k * stage.machine.rates().tick());
  }
}

TEST(Stepper, ReleasesActuatorsAndForces) {
  MovingStage stage("force_offset@load:force=3");
  stage.Advance();
  ASSERT_EQ(stage.plant.data->qfrc_applied[0], 3.0);
  ASSERT_NE(stage.plant.data->ctrl[0], 0.0);
  stage.stepper.Release(*stage.plant.data);
  EXPECT_EQ(stage.plant.data->qfrc_applied[0], 0.0);
  EXPECT_EQ(stage.plant.data->ctrl[0], 0.0);
}

TEST(Stepper, DoesNotAllocateWithEveryEffectInTheMachine) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "malloc belongs to the sanitizer";
  const Machine machine = test::Bonder().With(test::With(test::EveryEffectOfAb383()));
  const StartedPlant plant = StartPlant(machine, {});
  Stepper stepper(machine);
  Shaker control;
  control.amplitude = 0.01;
  const auto advance = [&] {
    for (int k = 0; k < 50; ++k) stepper.Advance(*plant.model, *plant.data, control);
  };
  EXPECT_EQ(test::CountAllocations(advance), 0);
  EXPECT_EQ(control.ticks, 50);
  EXPECT_FALSE(HasDiverged(*plant.data));
  EXPECT_GT(test::CountAllocations([&] { Stepper another(machine); }), 0)
      << "the counter does not count";
}

TEST(StartPlant, RestsWhereTheSensorsReadWhatTheyShould) {
  const Machine machine = test::Bonder();
  const StartedPlant plant = StartPlant(machine, {{"x", 1e-3}, {"z", -2e-3}});
  EXPECT_EQ(plant.model->ngeom, 0) << "scenery";
  mj_forward(plant.model.get(), plant.data.get());
  const std::vector<int>& addresses = machine.sensor_addresses();
  EXPECT_NEAR(plant.data->sensordata[addresses[0]], 1e-3, 1e-12);
  EXPECT_NEAR(plant.data->sensordata[addresses[1]], 0.0, 1e-6);
  EXPECT_NEAR(plant.data->sensordata[addresses[2]], -2e-3, 1e-12);
  for (int i = 0; i < plant.model->nv; ++i) EXPECT_EQ(plant.data->qvel[i], 0.0);
  EXPECT_GT(machine.plant().ngeom, 0);
}

TEST(HasDiverged, SaysWhatMujocoDoesNot) {
  const StartedPlant plant = StartPlant(test::Bonder(), {});
  mj_step(plant.model.get(), plant.data.get());
  EXPECT_FALSE(HasDiverged(*plant.data));
  plant.data->qvel[0] = std::numeric_limits<double>::quiet_NaN();
  mj_step(plant.model.get(), plant.data.get());
  EXPECT_TRUE(std::isfinite(plant.data->qvel[0])) << "MuJoCo has not reset it";
  EXPECT_TRUE(HasDiverged(*plant.data));
}

}  // namespace
}  // namespace mjdiag
