#pragma once
// Were two channels of a record sampled by the same clock? The lag of each behind the
// simulated plant is estimated in every tenth of the record; clocks that drift apart
// show as a difference of lags that grows with time.
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
// to tell it from a drift there is no answer. The drift counts if Student's t of it is
// significant at 0.1 %, with the scatter of the d_w about the line as its error: a
// model error that comes and goes makes that scatter large.

#include <Eigen/Core>
#include <optional>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

struct LagTrend {
  double drift = 0.0;    ///< of the lag from the start to the end [samples]
  double sd = 0.0;       ///< of the drift [samples]
  double freedom = 0.0;  ///< of sd
};

/// @param measured, simulated  the same channel, equally long, any unit
/// @return none if the signals are too unlike, or move in too few places, to tell
std::optional<LagTrend> FindLagTrend(const Eigen::VectorXd& measured,
                                     const Eigen::VectorXd& simulated);

/// Drift of `a` against `b` if it is significant and more than half a sample, else 0.
/// [samples]
double ClockDrift(const LagTrend& a, const LagTrend& b);

/// @param simulated  the nominal plant along the record, without noise
/// InputError names two channels whose clocks drift apart: in closed loop the reading
/// and the input or else the reference of an axis, in open loop a reading and the
/// input.
void CheckClocks(const Setup& setup, const Record& measured, const Record& simulated);

}  // namespace mjdiag
