#include "mjdiag/discovery/comparison/disturbance_estimate.h"

#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<DisturbanceEstimate> DisturbanceEstimates(const Machine& machine,
                                                      const FilterPath& path) {
  return DisturbanceEstimates(machine, path, SmoothForces(path));
}

std::vector<DisturbanceEstimate> DisturbanceEstimates(const Machine& machine,
                                                      const FilterPath& path,
                                                      const SmoothedForces& smoothed) {
  const std::vector<std::string> names = CoordinateNames(machine.plant());
  std::vector<DisturbanceEstimate> forces;
  for (std::size_t j = 0; j < path.dofs.size(); ++j) {
    const auto row = static_cast<Index>(j);
    const Index dof = path.dofs[j];
    DisturbanceEstimate force;
    force.joint = names[static_cast<std::size_t>(dof)];
    force.unit = IsLength(machine.plant(), static_cast<int>(dof)) ? "N" : "N m";
    force.value = smoothed.value.row(row).transpose();
    force.rms = Rms(force.value);
    force.sd = smoothed.sd[row];
    force.memory = path.noise.memory[row];
    forces.push_back(std::move(force));
  }
  return forces;
}

}  // namespace mjdiag
