#pragma once
// Filtering without delay, for recorded signals: forwards, then backwards in time. The
// gain is the filter's squared and the phase zero, so a Butterworth filter is 6 dB down
// at its cut-off frequency.
//
// Ends: the signal is continued by 3 n samples on either side, n the filter's order, by
// point reflection about the end sample (2 x[0] - x[k]), and each pass starts in the
// steady state of its first sample. This is filtfilt of MATLAB and Octave; SciPy's
// pads 3 (n + 1) unless told padlen = 3 n.

#include <Eigen/Core>

#include "mjdiag/signals/second_order_sections.h"

namespace mjdiag {

/// @param sections  the filter, without a pole at z = 1
/// @param signal    more than 3 n samples, else InputError
/// @return as many samples as the signal has
Eigen::VectorXd FilterZeroPhase(const SecondOrderSections& sections,
                                const Eigen::VectorXd& signal);

}  // namespace mjdiag
