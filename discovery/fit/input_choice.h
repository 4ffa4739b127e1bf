#pragma once
// How far the inputs of a run have to be smoothed for a machine (input_noise.h): by the
// likelihood of its filter, to first order along its path, behind the noise that suits each.
// Beside it the machine may rub, and every input be weaker or stronger: an input that a machine
// feels little of is explained by a lag, a mass or a weak motor, too, if nothing else is asked.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct InputChoice {
  Eigen::VectorXd widths;  ///< of every actuator [ticks]
  FilterNoise noise;       ///< that suits them
};

/// @param run     with the inputs as they were measured
/// @param path    of the machine with some inputs
/// @param whitenings  of the path
/// @param widths  by which these are smoothed
/// @param blocks  of what the machine lacks
InputChoice ChooseInputs(const Machine& machine, const MeasuredRun& run,
                         const FilterPath& path, const Whitenings& whitenings,
                         const Eigen::VectorXd& widths,
                         const std::vector<Block>& blocks);

/// What it costs, in -2 ln, to have them so.
double PriceOfWidths(const Eigen::VectorXd& widths);

}  // namespace mjdiag
