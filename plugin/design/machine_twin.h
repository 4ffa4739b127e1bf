#pragma once
// The twin of a machine for its diagnosis: the exact linear map where the machine is
// taken as linear, else its plant in MuJoCo, with all fault parameters, disturbances and
// whatever else is not known of it as unknowns.

#include <array>
#include <memory>

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"

namespace mjdiag {

/// Bandwidths of the gains with which a twin is pulled along, in parts of the control
/// rate: from 1 Hz at 8 kHz, to follow, to 100 Hz, to begin with.
inline constexpr std::array<double, 5> kTwinBandwidths = {1.25e-4, 4e-4, 1.25e-3, 4e-3,
                                                          1.25e-2};

/// Ticks of a block: after each there is another estimate.
inline constexpr Eigen::Index kTwinBlock = 8;

/// InputError on a machine whose sensors have no noise: it says how sure the twin is of
/// what it sees.
/// The force noise that it assumes is that of the machine's calibration.
MachineTwin MakeTwin(const Machine& machine, bool linear,
                     UncertaintyOptions options = {});

/// An estimator with that twin; null where there is nothing to estimate or a sensor has
/// no noise.
std::unique_ptr<TwinEstimator> MakeTwinEstimator(const Machine& machine, bool linear);

}  // namespace mjdiag
