#pragma once
// A stage of one axis with an encoder of 10 nm noise, and measurements of it with
// something put in: small enough that what looks at them takes seconds.

#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/changes.h"

namespace mjdiag::test {

struct Stage {
  Machine machine;

  /// @param rate  of its control [Hz]: what looks at fewer ticks is done earlier
  explicit Stage(double rate = 1000.0) : machine(Load(rate)) {}
  const Setup& setup() const { return machine.setup(); }
  Excitation Motion() const {
    return FollowTrajectory(setup(), setup().trajectories.Find("default"));
  }
  /// A closed-loop measurement with these effects and faults.
  Record Measure(const std::vector<std::string>& effects,
                 const std::vector<Fault>& faults = {}, std::uint64_t seed = 1) const {
    RunOptions options;
    options.seed = seed;
    return Simulate(machine.With(With(effects, faults)), Motion(), options);
  }

 private:
  // The stage of mjcf/emps in fewer and longer steps than its file has.
  static Machine Load(double rate) {
    const Setup setup =
        ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps",
                  {"sensors.q.noise_sd=1e-8", "rates.substeps=2",
                   "rates.control=" + std::to_string(rate), "compare.skip_samples=0"});
    const ModelPtr plant = LoadModel(setup.plant);
    plant->opt.timestep = setup.rates.step();
    PreparePlant(setup.physics, *plant);
    return {setup, *plant};
  }
};

}  // namespace mjdiag::test
