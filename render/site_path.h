#pragma once
// The path of a site, for example of a tool's tip, through the motion as it is drawn.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/render/amplification.h"

namespace mjdiag {

/// The site at the tool: the last one on the body farthest from the world, counted in
/// bodies. Nothing if the model has no site on a body that moves.
std::optional<int> ToolSite(const mjModel& model);

/// The site of that name; the tool's if the name is empty, nothing if it is "none".
/// InputError lists the sites if there is none of that name.
std::optional<int> PathSite(const mjModel& model, const std::string& name);

/// Positions of a site over time.
struct SitePath {
  std::vector<double> times;               ///< ascending [s]
  std::vector<Eigen::Vector3d> positions;  ///< [m]
};

/// Where the run's amplified motion takes the site. Uses `data` as work space.
SitePath DrawnPath(const mjModel& model, int site, const Amplification& amplification,
                   const Record& run, TimeRange range, mjData& data);

}  // namespace mjdiag
