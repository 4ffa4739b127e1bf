// Derivatives by numbers of a plant from one pass, against differences of whole runs.

#include "mjdiag/plugin/effects/number_forces.h"

#include <gtest/gtest.h>

#include <string>

#include "discovery/stage_under_test.h"
#include "mjdiag/plugin/replay/error_dynamics.h"

namespace mjdiag {
namespace {

/// Of every number, how far its derivative is from that of differences of runs, both in
/// averages of blocks of the length that the first order has. Modes that swing between two
/// samples are not in them: beside the largest of all derivatives they are nothing.
void ExpectAlike(const DiscoveryProblem& problem, double share) {
  const Eigen::Index channels = problem.run().outputs.rows();
  const Eigen::Index block = problem.Linearised({})->dynamics.block();
  const Eigen::MatrixXd rough =
      Averaged(problem.RoughNumberJacobian({}, {}), channels, block);
  const Eigen::MatrixXd exact =
      Averaged(problem.NumberJacobian({}, {}), channels, block);
  constexpr double kNothing = 1e-3;
  const double largest = exact.colwise().norm().maxCoeff();
  for (Eigen::Index i = 0; i < exact.cols(); ++i) {
    const DoubtedNumber& doubted = problem.numbers()[static_cast<std::size_t>(i)];
    const std::string name =
        doubted.is_lateness
            ? "lateness"
            : PlantNumberName(problem.machine().plant(), doubted.number);
    EXPECT_LT((rough.col(i) - exact.col(i)).norm(),
              share * exact.col(i).norm() + kNothing * largest)
        << name << " " << exact.col(i).norm();
  }
}

TEST(NumberForces, AreWhatDifferencesOfRunsShowOnTheStage) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = WithDoubts(stage.Pose(stage.Measure({})), {});
  ASSERT_EQ(problem.numbers().size(), 4u);  // mass, damper, motor, lateness
  ExpectAlike(problem, 0.02);
}

TEST(NumberForces, AreWhatDifferencesOfRunsShowOnTheBonder) {
  const Machine machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"));
  const Excitation motion =
      FollowTrajectory(machine.setup(), machine.setup().trajectories.Find("multi"));
  const DiscoveryProblem all =
      PoseProblem(machine, Simulate(machine, motion, {}), 1.0, 0.0);
  const DiscoveryProblem problem = WithDoubts(Beginning(all, 4000), {});
  ASSERT_GT(problem.numbers().size(), 10u);
  ExpectAlike(problem, 0.1);
}

// Dampers of modes that swing faster than the control: a force held over a tick is not
// theirs.
TEST(NumberForces, OfModesThatSwingWithinATickAreThoseOfEveryStep) {
  const Machine machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/ab383"));
  const Excitation motion =
      FollowTrajectory(machine.setup(), machine.setup().trajectories.Find("multi"));
  const DiscoveryProblem problem =
      Beginning(PoseProblem(machine, Simulate(machine, motion, {}), 1.0, 60.0), 4000)
          .Doubting({{FindPlantNumber(machine.plant(), "damping@u3"), 1.0},
                     {FindPlantNumber(machine.plant(), "damping@u4"), 1.0},
                     {FindPlantNumber(machine.plant(), "stiffness@u3"), 1.0}});
  const Eigen::Index block = problem.Linearised({})->dynamics.block();
  const Eigen::MatrixXd rough = Averaged(problem.RoughNumberJacobian({}, {}), 3, block);
  const Eigen::MatrixXd exact = Averaged(problem.NumberJacobian({}, {}), 3, block);
  for (Eigen::Index i = 0; i < exact.cols(); ++i) {
    EXPECT_LT((rough.col(i) - exact.col(i)).norm(), 0.3 * exact.col(i).norm()) << i;
  }
}

}  // namespace
}  // namespace mjdiag
