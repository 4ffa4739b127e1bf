#pragma once
// Effects that are a wave, amplitude sin(angle + phase), over a position or time: their
// parameters are amplitude, period or frequency, and phase, in this order.

#include <Eigen/Core>
#include <numbers>
#include <utility>

#include "mjdiag/plugin/effects/candidate_regressor.h"

namespace mjdiag {

inline constexpr double kTurn = 2.0 * std::numbers::pi;  ///< [rad]

/// Sine and cosine of an angle, with `value` the period or frequency.
/// @param entry  of the force, nq; empty: an error of a reading
CandidateRegressor WaveRegressor(const Eigen::VectorXd& entry,
                                 const Eigen::VectorXd& angle, double value);

/// Periods of a wave over x, from one period over the stroke on.
/// @param finest  quarters of a period over the stroke, at most
/// @param step    quarters from one to the next: 1 or 2 miss no maximum
ParameterScan PeriodScan(const Eigen::VectorXd& entry, const Eigen::VectorXd& x,
                         int finest, int step);

/// Frequencies of a wave over time, as close as a record of `duration` [s] tells apart.
ParameterScan FrequencyScan(const Eigen::VectorXd& entry, const ObservedMotion& motion,
                            double duration);

/// Phase and amplitude >= 0 of a sin(x) + b cos(x).
std::pair<double, double> AmplitudeAndPhase(double a, double b);

}  // namespace mjdiag
