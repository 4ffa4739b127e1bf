#pragma once
// How a candidate cause would show, to first order: the force (or the error of a
// reading) that it makes along the observed motion, with its shape parameters (a
// period, a frequency, a length) on a grid and its amplitudes free. Every grid point is
// a trial, and linear least squares on the innovations judges it (screening.h).

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/mechanical_model.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/observed_motion.h"

namespace mjdiag {

using Amplitudes = Eigen::VectorXd;
/// Values of the cause's parameters for amplitudes; none: not physical.
using Parameters = std::optional<std::map<std::string, double>>;

struct Trial {
  Eigen::MatrixXd signals;  ///< samples x amplitudes: force or error of the reading
  Eigen::MatrixXd entry;    ///< nq x amplitudes, of forces; empty: errors of a reading
  std::function<Parameters(const Amplitudes&)> parameters;
  /// An error of readings that is far too fast for the observer to follow: it shows in
  /// the innovations as it is.
  bool fast = false;
  bool summed = false;  ///< all signals have one amplitude: a knob of several joints
};

/// All trials of a candidate on a small grid. Empty if the motion does not excite it,
/// or if it has a sweep instead.
std::vector<Trial> MakeTrials(const mjModel& plant, const MechanicalModel& model,
                              const Candidate& candidate, const ObservedMotion& motion);

/// Trials over one parameter that has to be met closely: a period or a frequency. Each
/// is the sine and the cosine of an angle, which grows evenly from one to the next.
struct Sweep {
  std::vector<double> values;  ///< in order, close enough to miss no maximum
  Eigen::VectorXd angle;       ///< of the first value, samples [rad]
  Eigen::VectorXd increment;   ///< from one value to the next, samples [rad]
  /// Errors of readings with a lower value (a period) are `fast`.
  double fast_below = 0.0;
  std::function<Trial(double)> make;
};

/// @param duration  of what is fitted [s], for the resolution of frequencies
std::optional<Sweep> MakeSweep(const MechanicalModel& model, const Candidate& candidate,
                               const ObservedMotion& motion, double duration);

/// Phase and amplitude >= 0 of a sin(x) + b cos(x).
std::pair<double, double> AmplitudeAndPhase(double a, double b);

}  // namespace mjdiag
