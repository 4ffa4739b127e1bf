#pragma once
// How much mismatch the sensor noise alone explains. The noise of every sensor is
// estimated from the measured record itself. What it does to a channel is the
// difference of two runs of the same machine, with that noise and without: in closed
// loop the controller passes noise on to the actuators and the motion, so that their
// floor, too, is known, and how it is coloured.
//
// Assumes that a sensor's noise is white up to half the sampling rate. Of a record that
// was low-passed before it was stored the floor comes out too low.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <string>

#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record.h"
#include "mjdiag/signals/spectrum.h"

namespace mjdiag {

/// Number of independent values that the mean square of n samples of a stationary
/// signal with that spectrum S holds: n (sum S)^2 / (m sum S^2) over the m bins. n for
/// white noise, less for coloured noise.
double IndependentSamples(const Spectrum& spectrum, Eigen::Index n);

/// Noise of every sensor [unit]: what `measured` shows of it, at least its quantisation
/// noise; of sensors that were not measured what their channel says.
Eigen::VectorXd MeasuredNoise(const Channels& channels, const Record& measured);

/// Floor of every sensor and actuator channel of the setup, whose noise_sd is trusted
/// (see MeasuredNoise).
/// @param clean    Simulate of the same excitation and options with noise_scale = 0
/// @param options  of that run; its seed and the next ones draw the noise, in parallel
/// @param skip     samples left out at the start
std::map<std::string, NoiseFloor> EstimateNoiseFloor(const Machine& machine,
                                                     const Excitation& excitation,
                                                     const Record& clean,
                                                     const RunOptions& options,
                                                     Eigen::Index skip);

}  // namespace mjdiag
