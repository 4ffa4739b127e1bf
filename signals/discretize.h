#pragma once
// From a continuous system dx/dt = A x + B u, y = C x + D u to one that steps every
// T seconds.

#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// Exact for an input that is held over every sample (zero-order hold), the way a
/// digital controller drives a machine:
///   [Ad Bd; 0 I] = exp([A B; 0 0] T),   Cd = C, Dd = D
/// by Pade approximation with scaling and squaring, after the states were balanced (a
/// diagonal scaling by powers of two), because mechanical models have rows of 1 and of
/// K/M ~ 1e8 next to each other.
/// @param sample_time  T [s], > 0
/// InputError if the system is not continuous, its shapes do not fit or T is not
/// positive; NumericalError if the exponential is not finite.
StateSpace DiscretizeZoh(const StateSpace& continuous, double sample_time);

/// The bilinear transform s = (2 / T) (z - 1) / (z + 1), for filters: a stable system
/// stays stable and the frequency response is kept up to a warping of the frequency
/// axis, tan(pi f T) = (w T / 2) with w the continuous angular frequency. With
/// P = (I - A T / 2)^-1:
///   Ad = P (I + A T / 2), Bd = P B T, Cd = C P, Dd = D + C P B T / 2
/// @param sample_time  T [s], > 0
/// InputError as above; NumericalError if A has the eigenvalue 2 / T.
StateSpace DiscretizeTustin(const StateSpace& continuous, double sample_time);

}  // namespace mjdiag
