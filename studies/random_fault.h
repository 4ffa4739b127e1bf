#pragma once
// Draws of faults for `mjdiag study --preset random-faults`, sealed from what is to find
// them: a diagnosis sees the record and the healthy machine, nothing else.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/studies/machine_study.h"

namespace mjdiag {

/// What may be drawn of a fault: deviations from healthy of `least` to `below` downwards
/// and of `least` to `above` upwards, evenly in their logarithm. A side that is not wider
/// than `least` is none.
struct DrawRange {
  std::string name;
  double healthy = 1.0;
  double least = 0.0;
  double below = 0.0;
  double above = 0.0;
};

/// Of [studies.random_least], [studies.random_low] and [studies.random_high]: values of
/// each fault nearest to healthy, and its lowest and highest. InputError if one of
/// them lacks a fault of the first, or nothing is left to be drawn.
std::vector<DrawRange> DrawRanges(const Setup& setup);

struct RandomDraw {
  std::uint64_t seed = 0;          ///< of the noise, too
  std::vector<SizedFault> faults;  ///< none in one of five draws, else one to three
  Eigen::Index from = 0;           ///< first sample that the diagnosis sees
};

/// One of four draws begins at the first sample, where the machine is at rest; the others
/// anywhere in the first half of the motion.
/// @param samples  of the motion
RandomDraw DrawFaults(const std::vector<DrawRange>& ranges, Eigen::Index samples,
                      std::uint64_t seed);

/// Deviations from healthy: "zeta_x +0.2, gamma +0.01"; "none".
std::string ListFaults(const Setup& setup, const std::vector<SizedFault>& faults);

}  // namespace mjdiag
