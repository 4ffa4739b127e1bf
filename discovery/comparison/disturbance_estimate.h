#pragma once
// The force that a model lacks at every joint along a measured motion: the latent forces of
// the filter that follows it (force_filter.h), given all readings before and after
// (force_smoother.h), behind the noise that is most likely (noise_fit.h).

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/force_smoother.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct DisturbanceEstimate {
  std::string joint;      ///< or coordinate of one (tangent_coordinates.h)
  std::string unit;       ///< "N" or "N m"
  Eigen::VectorXd value;  ///< of every sample
  double rms = 0.0;       ///< of value
  double sd = 0.0;        ///< of its error, mean square along the motion
  double memory = 0.0;    ///< how long it lasts [s]
};

std::vector<DisturbanceEstimate> DisturbanceEstimates(const Machine& machine,
                                                      const FilterPath& path);
/// @param smoothed  along that path
std::vector<DisturbanceEstimate> DisturbanceEstimates(const Machine& machine,
                                                      const FilterPath& path,
                                                      const SmoothedForces& smoothed);

}  // namespace mjdiag
