#include "mjdiag/plugin/replay/error_dynamics.h"

#include <gtest/gtest.h>

#include <random>

#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/screening/trial.h"

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

/// First order of the run of a problem, its first samples.
ErrorDynamics DynamicsOf(const DiscoveryProblem& problem, Index samples, Index block) {
  ErrorDynamics dynamics(problem.observer, block);
  FollowRun(problem.machine.setup(), problem.machine.plant(), {},
            Beginning(problem, samples).run, problem.observer, problem.machine.linear(),
            dynamics);
  return dynamics;
}

// A force that the model lacks, small enough that dry friction and saturation stay out:
// the nonlinear replay and the linear prediction agree.
TEST(ErrorDynamics, PredictsWhatAMissingForceDoesToTheReplay) {
  const test::Stage stage;
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  quiet.effects = {ParseEffect("viscous_friction@load:coefficient=0.5")};
  const Excitation motion =
      FollowTrajectory(stage.setup, stage.setup.trajectories.Find("default"));
  DiscoveryProblem problem = stage.Pose(stage.Measure({}));
  problem.run = ToMeasuredRun(stage.setup, Simulate(stage.machine, motion, quiet));
  ErrorDynamics dynamics(problem.observer, 1);
  const Track track = FollowRun(stage.machine, {}, problem.run, problem.observer,
                                problem.machine.linear(), dynamics);
  const ObservedMotion observed = ObserveMotion(*stage.plant, problem.run, track);
  const MatrixXd force = -0.5 * observed.velocity.transpose();
  const VectorXd predicted = dynamics.OfForces(MatrixXd::Ones(1, 1), force);
  const VectorXd seen = problem.Scaled(track);
  EXPECT_LT((predicted - seen).norm(), 0.02 * seen.norm());
}

TEST(ErrorDynamics, LosesLittleByBlocks) {
  const test::Stage stage;
  const DiscoveryProblem problem = stage.Pose(stage.Measure({}));
  const Index n = 2000;
  const MatrixXd force =
      VectorXd::LinSpaced(n, 0.0, 20.0).array().sin().matrix();  // 3 Hz
  const auto response = [&](Index block) {
    const ErrorDynamics dynamics = DynamicsOf(problem, n, block);
    return dynamics.OfForces(MatrixXd::Ones(1, 1), force);
  };
  const MatrixXd fine = Averaged(response(1), 1, 4);
  EXPECT_LT((fine - response(4)).norm(), 0.01 * fine.norm());
}

TEST(ErrorDynamics, HasAnAdjoint) {
  mjdiag::Setup setup = ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383");
  const ModelPtr plant = LoadPlant(setup);
  RunOptions options;
  const Excitation motion = FollowTrajectory(setup, setup.trajectories.Find("x"));
  const DiscoveryProblem problem =
      PoseProblem(machine, Simulate(machine, motion, options), 0.7, 0.0);
  const Index n = 600;
  for (const Index block : {1, 3}) {
    const ErrorDynamics dynamics = DynamicsOf(problem, n, block);
    const VectorXd e = Noise(3 * (n / block), 1);
    const ErrorDynamics::Adjoint adjoint = dynamics.AdjointOf(e);
    const VectorXd signal = Noise(n, 2);
    const VectorXd mean =
        Averaged(signal, 1, block) / std::sqrt(static_cast<double>(block));
    for (Index joint = 0; joint < plant->nv; ++joint) {
      const MatrixXd entry = VectorXd::Unit(plant->nv, joint);
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
  const mjdiag::Setup setup = ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383");
  const ModelPtr plant = LoadPlant(setup);
  const Record measured =
      Simulate(machine, FollowTrajectory(setup, setup.trajectories.Find("multi")), {});
  const DiscoveryProblem problem =
      Beginning(PoseProblem(machine, measured, 0.8, 0.0), 6000);
  for (const Index block : {1, 3}) {
    ErrorDynamics dynamics(problem.observer, block);
    const Track track = FollowRun(machine, {}, problem.run, problem.observer,
                                  problem.machine.linear(), dynamics);
    const ObservedMotion motion = ObserveMotion(*plant, problem.run, track);
    for (const char* name : {"X", "Y", "Z"}) {
      const int joint = mj_name2id(plant.get(), mjOBJ_JOINT, name);
      const double coefficient = 1e-5 * plant->dof_damping[joint];
      const EffectSpec effect{"viscous_friction", name, {{"coefficient", coefficient}}};
      const VectorXd response =
          problem.Residual({{}, {effect}}) - problem.Scaled(track);
      const VectorXd blocks = Averaged(response, 3, block);
      const VectorXd predicted =
          dynamics.OfForces(VectorXd::Unit(plant->nv, joint),
                            -coefficient * motion.velocity.row(joint).transpose());
      EXPECT_LT((predicted + blocks).norm(), 0.05 * blocks.norm())
          << name << ", block " << block;
    }
  }
}

}  // namespace
}  // namespace mjdiag
