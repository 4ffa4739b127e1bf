#include "mjdiag/plugin/replay/error_dynamics.h"

#include <gtest/gtest.h>

#include <random>

#include "plugin/replay/replay.h"
#include "support/bonder.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Noise(Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(n, [&] { return normal(generator); });
}

Record RunOf(const Machine& machine, const std::string& trajectory) {
  const mjdiag::Setup& setup = machine.setup();
  return Simulate(machine, FollowTrajectory(setup, setup.trajectories.Find(trajectory)),
                  {});
}

/// First order of the first samples of a run.
ErrorDynamics DynamicsOf(const test::Replay& replay, Index samples, Index block) {
  ErrorDynamics dynamics(replay.observer, block);
  RunPredictor(replay.machine, {}, replay.Beginning(samples).run, replay.observer,
               dynamics);
  return dynamics;
}

// A force that the model lacks, small enough that dry friction and saturation stay out:
// the nonlinear replay and the linear prediction agree.
TEST(ErrorDynamics, PredictsWhatAMissingForceDoesToTheReplay) {
  const test::Stage stage;
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Machine damped =
      stage.machine.With(test::With({"viscous_friction@load:coefficient=0.5"}));
  const test::Replay replay(stage.machine, Simulate(damped, stage.Motion(), quiet));
  ErrorDynamics dynamics(replay.observer, 1);
  const InnovationSequence track =
      RunPredictor(replay.machine, {}, replay.run, replay.observer, dynamics);
  const ObservedMotion observed = ObserveMotion(replay.machine, replay.run, track);
  const MatrixXd force = -0.5 * observed.velocity.transpose();
  const VectorXd predicted = dynamics.OfForces(MatrixXd::Ones(1, 1), force);
  const VectorXd seen = replay.Scaled(track);
  EXPECT_LT((predicted - seen).norm(), 0.02 * seen.norm());
}

// The same of a sensor that is read now and then: the replay is not pulled elsewhere, and
// nothing is seen of it there.
TEST(ErrorDynamics, PredictsItWhereTheSensorIsReadNowAndThen) {
  const test::Stage stage;
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Machine damped =
      stage.machine.With(test::With({"viscous_friction@load:coefficient=0.5"}));
  test::Replay replay(stage.machine, Simulate(damped, stage.Motion(), quiet));
  replay.run.measured.setConstant(1, replay.run.samples(), true);
  for (Index k = 0; k < replay.run.samples(); ++k) {
    if (k % 3 != 0 || (k > 2000 && k < 2400)) replay.run.measured(0, k) = false;
  }
  for (const Index block : {1, 4}) {
    ErrorDynamics dynamics(replay.observer, block);
    const InnovationSequence track =
        RunPredictor(replay.machine, {}, replay.run, replay.observer, dynamics);
    const ObservedMotion observed = ObserveMotion(replay.machine, replay.run, track);
    const MatrixXd force = -0.5 * observed.velocity.transpose();
    const VectorXd predicted = dynamics.OfForces(MatrixXd::Ones(1, 1), force);
    const VectorXd seen = Averaged(replay.Scaled(track), 1, block);
    EXPECT_LT((predicted - seen).norm(), 0.02 * seen.norm()) << block;
  }
}

TEST(ErrorDynamics, LosesLittleByBlocks) {
  const test::Stage stage;
  const test::Replay replay(stage.machine, stage.Measure({}));
  const Index n = 2000;
  const MatrixXd force =
      VectorXd::LinSpaced(n, 0.0, 20.0).array().sin().matrix();  // 3 Hz
  const auto response = [&](Index block) {
    const ErrorDynamics dynamics = DynamicsOf(replay, n, block);
    return dynamics.OfForces(MatrixXd::Ones(1, 1), force);
  };
  const MatrixXd fine = Averaged(response(1), 1, 4);
  EXPECT_LT((fine - response(4)).norm(), 0.01 * fine.norm());
}

// What a force has done to one record is forgotten in the next, whether that begins
// between two blocks or within one.
TEST(ErrorDynamics, BeginsAnewWithEveryRecord) {
  const test::Stage stage;
  const test::Replay replay(stage.machine, stage.Measure({}));
  constexpr Index kBlock = 4;
  for (const Index n : {1000, 1002}) {
    test::Replay both = replay;
    both.run = Joined({Part(replay.run, 0, n), Part(replay.run, 0, 1000)});
    ErrorDynamics dynamics(replay.observer, kBlock);
    RunPredictor(both.machine, {}, both.run, both.observer, dynamics);
    VectorXd force = VectorXd::Zero(n + 1000);
    force.head(n - 4).setOnes();
    const VectorXd response = dynamics.OfForces(MatrixXd::Ones(1, 1), force);
    const Index later = n / kBlock + 1;
    EXPECT_GT(response.head(later - 2).cwiseAbs().maxCoeff(), 1.0);
    EXPECT_EQ(response.tail(response.size() - later).cwiseAbs().maxCoeff(), 0.0) << n;
  }
}

TEST(ErrorDynamics, HasAnAdjoint) {
  const Machine machine = test::Bonder();
  const mjModel& plant = machine.plant();
  const test::Replay replay(machine, RunOf(machine, "x"));
  const Index n = 600;
  for (const Index block : {1, 3}) {
    const ErrorDynamics dynamics = DynamicsOf(replay, n, block);
    const VectorXd e = Noise(3 * (n / block), 1);
    const ErrorDynamics::Adjoint adjoint = dynamics.AdjointOf(e);
    const VectorXd signal = Noise(n, 2);
    const VectorXd mean =
        Averaged(signal, 1, block) / std::sqrt(static_cast<double>(block));
    for (Index joint = 0; joint < plant.nv; ++joint) {
      const MatrixXd entry = VectorXd::Unit(plant.nv, joint);
      const double forward = e.dot(dynamics.OfForces(entry, signal).col(0));
      EXPECT_NEAR(forward, adjoint.forces.col(joint).dot(mean),
                  1e-9 * (1.0 + std::abs(forward)))
          << joint << ", block " << block;
    }
    for (Index sensor = 0; sensor < 3; ++sensor) {
      const double forward = e.dot(dynamics.OfReadings(sensor, signal).col(0));
      EXPECT_NEAR(forward, adjoint.readings.col(sensor).dot(mean),
                  1e-9 * std::abs(forward))
          << sensor << ", block " << block;
    }
  }
}

// The bonder's guides and its Z bearing stick and slide in turn: the first order has to
// know when. Y stands still most of the time, held by 2 N.
TEST(ErrorDynamics, PredictsASmallForceBesideDryFriction) {
  const Machine machine = test::Bonder();
  const mjModel& plant = machine.plant();
  const test::Replay replay =
      test::Replay(machine, RunOf(machine, "multi")).Beginning(6000);
  for (const Index block : {1, 3}) {
    ErrorDynamics dynamics(replay.observer, block);
    const InnovationSequence track =
        RunPredictor(machine, {}, replay.run, replay.observer, dynamics);
    const ObservedMotion motion = ObserveMotion(machine, replay.run, track);
    for (const char* name : {"X", "Y", "Z"}) {
      const int joint = mj_name2id(&plant, mjOBJ_JOINT, name);
      const double coefficient = 1e-5 * plant.dof_damping[joint];
      const PlacedEffect effect =
          Place("viscous_friction", name, {{"coefficient", coefficient}});
      const VectorXd response =
          replay.Scaled(replay.Follow({{}, {effect}})) - replay.Scaled(track);
      const VectorXd blocks = Averaged(response, 3, block);
      const VectorXd predicted =
          dynamics.OfForces(VectorXd::Unit(plant.nv, joint),
                            -coefficient * motion.velocity.row(joint).transpose());
      EXPECT_LT((predicted + blocks).norm(), 0.05 * blocks.norm())
          << name << ", block " << block;
    }
  }
}

}  // namespace
}  // namespace mjdiag
