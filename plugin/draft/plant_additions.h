#pragma once
// A plant with what it lacks: the MJCF of its author, edited and not generated, with names,
// sensors and motors that the setup needs. Of a URDF it is the MJCF that MuJoCo makes of it.

#include <mujoco/mujoco.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

struct PlantAdditions {
  std::vector<int> named_joints;     ///< nameless ones that get their name (GivenName)
  std::vector<int> named_actuators;  ///< the same
  struct Element {
    std::string name;
    std::string joint;
  };
  std::vector<Element> sensors;  ///< <jointpos>
  std::vector<Element> motors;   ///< <motor>
  std::optional<double> timestep;
  bool euler = false;  ///< in the place of an integrator that setups do not take
  bool is_urdf = false;

  bool any() const {
    return is_urdf || euler || timestep || !named_joints.empty() ||
           !named_actuators.empty() || !sensors.empty() || !motors.empty();
  }
};

/// A model as its author wrote it.
struct SourcePlant {
  ModelPtr model;
  bool is_urdf = false;
  std::string mjcf;  ///< what MuJoCo makes of a URDF; empty of an MJCF
};

/// InputError as LoadModel.
SourcePlant LoadSourcePlant(const std::filesystem::path& file);

/// A name that no element of that kind has, `wanted` if it is free.
std::string FreeName(const mjModel& model, mjtObj kind, const std::string& wanted);

/// The text of the plant to be written into `folder`.
std::string PlantWith(const std::filesystem::path& file, const SourcePlant& source,
                      const PlantAdditions& additions,
                      const std::filesystem::path& folder);

}  // namespace mjdiag
