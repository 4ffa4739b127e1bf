#pragma once
// The state of a machine at a moment of a measured run.

#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/operating_point.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// Readings and inputs are those of the quadratic polynomials of least squares through
/// what was measured within 20 ms of the moment, three samples to each side at least
/// (A. Savitzky, M. J. E. Golay, Analytical Chemistry 36, 1964). The configuration is the
/// one in which position sensors read them (StartPosition), velocity and acceleration
/// are those of the configurations on both sides; where position sensors see no motion,
/// sensors of velocities do.
/// @param time  of the record's own clock [s]. InputError outside of the record
/// NumericalError if no configuration gives the readings.
OperatingPoint MomentOf(const Machine& machine, const Record& record, double time);

}  // namespace mjdiag
