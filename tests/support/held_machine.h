#pragma once
// A machine that falls without its controller, and measurements of it: the machine that is
// measured takes finer steps than its model, has what is put into it, and is held by a
// controller that the setup of the model does not have.

#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "support/changes.h"
#include "support/temporary_folder.h"

namespace mjdiag::test {

struct HeldMachine {
  std::string plant;       ///< MJCF of the model
  std::string channels;    ///< rates, sensors and actuators of the setup
  std::string controller;  ///< axes and the trajectory "default"
  int substeps = 8;        ///< of the machine that is measured

  Machine Model() const { return Load(plant, "", 1); }

  /// @param machine  MJCF of what is measured, by default that of the model
  Record Measure(const std::vector<std::string>& effects,
                 const std::string& machine = "") const {
    const Machine held = Load(machine.empty() ? plant : machine, controller, substeps);
    return Simulate(
        held.With(With(effects)),
        FollowTrajectory(held.setup(), held.setup().trajectories.Find("default")), {});
  }

 private:
  Machine Load(const std::string& mjcf, const std::string& more, int steps) const {
    const TemporaryFolder folder;
    folder.Write("plant.xml", mjcf);
    folder.Write("setup.toml",
                 "schema = \"mjdiag.setup/1\"\nname = \"machine\"\n"
                 "plant = \"plant.xml\"\n" +
                     channels + more);
    const Setup setup =
        ReadSetup(folder.path().string(), {"rates.substeps=" + std::to_string(steps)});
    const ModelPtr loaded = LoadModel(setup.plant);
    loaded->opt.timestep = setup.rates.step();
    PreparePlant(setup.physics, *loaded);
    return {setup, *loaded};
  }
};

}  // namespace mjdiag::test
