#pragma once
// How a long run is looked at first. What is large and slow shows in a part of what was measured,
// and takes a part of the time there; how much of it does not grow with the run. Steps take their
// time whether somebody looks or not: of a machine that takes few, all of the motion is looked at
// once in some ticks (coarser_run.h), of one that takes many, pieces.

#include <Eigen/Core>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct FirstLook {
  MeasuredRun run;       ///< all of it, or pieces of every record, at every tick
  bool is_part = false;  ///< whether it is of pieces
  int ticks = 1;         ///< once in so many it is looked at
};

/// Of 2500 readings and 10,000 physics steps about, a quarter of the run at least.
/// @param reading_sd  of every sensor, by itself
FirstLook FirstLookAt(const Machine& machine, const MeasuredRun& whole,
                      const Eigen::VectorXd& reading_sd);

/// Whether readings between those of a path tell more than these: where most of an innovation
/// is noise of the reading. What a model lacks is finer there, and no more.
bool TellsMoreInBetween(const FilterPath& path);

/// The noise of a path in ticks of another length: a white force is held over a tick.
FilterNoise NoiseInTicksOf(const FilterPath& path, double sample_time);

}  // namespace mjdiag
