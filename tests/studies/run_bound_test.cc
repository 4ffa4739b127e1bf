#include "mjdiag/studies/run_bound.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/studies/bound_study.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

struct WornBonder {
  Machine machine = test::Bonder({"trajectories.multi.duration=0.5"});
  Excitation motion = DefaultMotion(machine.setup());
  VectorXd deviations = VectorXd::Zero(8);
  RunOptions options;
  Machine worn = machine;

  WornBonder() {
    deviations << 0.2, 0.0, 0.0, -0.3, 0.0, -0.02, 0.0, 0.1;
    worn = machine.With({{{"zeta_x", 1.2}, {"beta_y", 0.7}, {"eta_y", 0.98}}, {}});
    options.disturbances["gamma"] = 0.1;
  }
};

// By another way: central differences of the linear plant, from commands without noise.
TEST(RunBound, IsThatOfDifferencesOnTheLinearPlant) {
  const WornBonder bonder;
  const Record record = SimulateLinear(bonder.worn, bonder.motion, bonder.options);
  const VectorXd bound = RunBound(bonder.machine, bonder.deviations, record, 0, true);
  const VectorXd differences =
      FaultBoundAt(bonder.machine, bonder.motion, bonder.deviations);
  for (Eigen::Index i = 0; i < bound.size(); ++i) {
    EXPECT_NEAR(bound[i] / differences[i], 1.0, 0.03) << i;
  }
}

TEST(RunBound, GrowsWhereTheStartIsUnknownAndTheRecordShorter) {
  const WornBonder bonder;
  for (const bool linear : {true, false}) {
    const Record record =
        linear ? SimulateLinear(bonder.worn, bonder.motion, bonder.options)
               : Simulate(bonder.worn, bonder.motion, bonder.options);
    const VectorXd whole =
        RunBound(bonder.machine, bonder.deviations, record, 0, linear);
    const VectorXd cut =
        RunBound(bonder.machine, bonder.deviations, record, 1000, linear);
    for (Eigen::Index i = 0; i < whole.size(); ++i) {
      EXPECT_GE(cut[i], whole[i]) << i;
      EXPECT_LE(cut[i], 10.0 * whole[i]) << i;
    }
  }
}

}  // namespace
}  // namespace mjdiag
