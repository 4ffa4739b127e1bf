#pragma once
// A run looked at once in some control ticks: its machine runs on between the readings that
// are kept, step by step, behind the inputs that it had. What is slow shows in these as in all
// of them, and takes a part of the time.

#include <Eigen/Core>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// The machine whose control tick is that many of this one's, in the same physics steps.
Machine InTicksOf(const Machine& machine, int ticks);

/// Every so many readings of a run, from the start of each record on; what is left of a record
/// is cut off.
MeasuredRun Coarser(const MeasuredRun& run, int ticks);

/// How many ticks at most a look may take that sees the motion, and leaves that many samples: a
/// cubic through two readings on either side tells that between them to a tenth of what changes
/// from one to the next, as it does of a sine that is looked at four times a period, or to the
/// noise of the readings. 1 where none does, and of a run whose drives are switched, or sensors
/// read more seldom: what these do in a tick is not the same all through it.
/// @param reading_sd  of every sensor, by itself
int TicksThatShowMotion(const MeasuredRun& run, const Eigen::VectorXd& reading_sd,
                        Eigen::Index samples);

}  // namespace mjdiag
