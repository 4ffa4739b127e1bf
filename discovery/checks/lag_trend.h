#pragma once
// How late is a measured signal behind a simulated one, and does that grow with time? The
// lag is estimated in every tenth of the record.
//
// In a window, with s the simulated and m the measured signal, both as differences over
// a few samples (so that drifting axes count for little), the lag d [samples] is the
// one of
//   m[k] = a + b k + g s[k - d]
// solved by Gauss-Newton, with s between samples by cubic interpolation.
//
// Errors of the model shift signals, too, but by the same time wherever the motion is
// the same. Over the windows w with their middle t_w in -1/2 .. 1/2 of the record,
//   d_w = d_0 + drift t_w + c / f_w
// is fitted with the weights sum (ds/dk)^2, f_w the mean frequency of s there: the
// last term is for motions that get faster or slower (a phase error is a lag of a
// share of the period). It is left out if f_w hardly varies, and without the windows
// to tell it from a drift there is no answer.

#include <Eigen/Core>
#include <array>
#include <optional>

namespace mjdiag {

struct LagTrend {
  double drift = 0.0;    ///< of the lag from the start to the end [samples]
  double sd = 0.0;       ///< of the drift [samples]
  double freedom = 0.0;  ///< of sd
};

/// Which tenths of a record count.
using LagWindows = std::array<bool, 10>;

/// Those in which a signal acts: changes a twentieth as much as where it changes most, at
/// least.
LagWindows ActiveWindows(const Eigen::VectorXd& signal);

/// @param measured, simulated  the same channel, equally long, any unit
/// @param windows  of it, that are looked at
/// @return none if the signals are too unlike, or move in too few places, to tell
std::optional<LagTrend> FindLagTrend(const Eigen::VectorXd& measured,
                                     const Eigen::VectorXd& simulated,
                                     const LagWindows& windows);
std::optional<LagTrend> FindLagTrend(const Eigen::VectorXd& measured,
                                     const Eigen::VectorXd& simulated);

/// Drift of `a` against `b` if Student's t of it is significant at 0.1 %, with the scatter
/// of the lags about the line as its error, and it is more than half a sample; else 0.
/// [samples]
double ClockDrift(const LagTrend& a, const LagTrend& b);

/// A signal as its lags are looked for in it: differences over four samples.
Eigen::VectorXd LagDifferences(const Eigen::VectorXd& signal);

}  // namespace mjdiag
