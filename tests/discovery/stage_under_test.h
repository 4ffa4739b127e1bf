#pragma once
// A stage of one axis with an encoder of 10 nm noise, and measurements of it with
// something put in: small enough that a discovery takes seconds.

#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/runtime/simulation.h"

namespace mjdiag::test {

struct Stage {
  Setup setup = ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps",
                          {"sensors.q.noise_sd=1e-8", "rates.substeps=2",
                           "rates.control=2000.0", "compare.skip_samples=0"});
  ModelPtr plant = Load(setup);

  /// A closed-loop measurement with these effects and faults.
  Record Measure(const std::vector<std::string>& effects,
                 const std::vector<Fault>& faults = {}, std::uint64_t seed = 1) const {
    RunOptions options;
    for (const std::string& effect : effects) {
      options.effects.push_back(ParseEffect(effect));
    }
    options.faults = faults;
    options.seed = seed;
    return Simulate(
        machine, FollowTrajectory(setup, setup.trajectories.Find("default")), options);
  }

  DiscoveryProblem Pose(const Record& measured) const {
    return PoseProblem(machine, measured, 0.7, 0.0);
  }

 private:
  static ModelPtr Load(Setup& setup) {
    ModelPtr model = LoadModel(setup.plant);
    model->opt.timestep = setup.rates.tick() / setup.rates.substeps;
    PreparePlant(setup, *model);
    return model;
  }
};

}  // namespace mjdiag::test
