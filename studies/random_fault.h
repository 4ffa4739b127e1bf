#pragma once
// Draws of faults, sealed from what is to find them: a diagnosis sees the record and the
// healthy machine, nothing else.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/studies/machine_study.h"

namespace mjdiag {

struct RandomDraw {
  std::uint64_t seed = 0;         ///< of the noise, too
  std::vector<DrawnAxis> faults;  ///< in the order of the axes
  Eigen::Index from = 0;          ///< first sample that the diagnosis sees
};

/// Faults of those axes, whose ranges are at most one on either side of healthy: up or
/// down as often, evenly in the logarithm of the deviation. Records that do not begin at
/// the first sample, where the machine is at rest, begin anywhere in the first half of the
/// motion.
/// @param axes     must outlive the draw
/// @param samples  of the motion
RandomDraw DrawFaults(const AskNames& ask, const std::vector<PlanAxis>& axes,
                      Eigen::Index samples, std::uint64_t seed);

/// Deviations from healthy: "zeta_x +0.2, gamma +0.01"; "none".
std::string ListFaults(const std::vector<DrawnAxis>& faults);

}  // namespace mjdiag
