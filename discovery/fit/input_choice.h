#pragma once
// How far the inputs of a run have to be smoothed for a machine (input_noise.h): over as many
// ticks as make its filter, with its noise anew, likeliest. A noise of the inputs that is not
// known makes a machine heavy, late or weak.

#include <Eigen/Core>
#include <optional>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

struct InputChoice {
  double width = 0.0;  ///< of all inputs [ticks]
  FilterPath path;     ///< of the machine with these
};

/// None if nothing is gained beyond the price.
/// @param run    with the inputs as they were measured
/// @param path   of the machine with them smoothed over `width`
std::optional<InputChoice> ChooseInputs(const Machine& machine, const MeasuredRun& run,
                                        const Eigen::VectorXd& reading_sd,
                                        const FilterPath& path, double width,
                                        const IsTimeOver& is_over);

/// Whether a little smoothing takes anything from the inputs: they were measured with noise.
bool InputsAreNoise(const MeasuredRun& run);

/// The run with its inputs smoothed over so many ticks.
MeasuredRun WithInputsOver(const MeasuredRun& run, double width);

/// What it costs, in -2 ln, to have them so.
double PriceOfWidth(double width);

}  // namespace mjdiag
