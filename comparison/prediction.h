#pragma once
// How far ahead a model predicts a machine that it cannot be left alone with: one that
// falls without a controller that nobody wrote down, or goes another way after the smallest
// difference. From the states of an observer that follows the measured motion, which know
// the readings up to the one before, the plant runs on with the measured inputs alone. What
// it then reads after a horizon of h ticks, less what was measured, is the error of a
// prediction over h; after one tick that is the innovation of the observer.
//
// Of all bandwidths of the observer from a sixth of the control rate down by factors of
// three, that is taken at which its innovations e are likeliest,
//
//   -2 ln L = m ln (sum e^T S^-1 e / m) + n ln det S,     S = C P C^T + R,
//
// for m values in n ticks, the noise being known to a common factor (missing_force.h), as if what the model lacks were white forces: the states are then as near to the truth
// as the model allows. Effects with a memory begin every prediction without it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

/// A run beside an observer that follows it.
struct FollowedRun {
  MeasuredRun run;
  Observer observer;
  Track track;
};

/// The run with the observer of the likeliest innovations.
/// @param noise_sd  of every sensor, all > 0; against the motion it may be larger
///                  (motion_noise.h)
/// NumericalError if the plant stays beside the run at no bandwidth.
FollowedRun FollowLikeliest(const Machine& machine, MeasuredRun run,
                            const Eigen::VectorXd& noise_sd);

/// The run of the machine with those changes, with the observer of the machine without
/// them, of that bandwidth [Hz]. NumericalError as above.
FollowedRun FollowAt(const Machine& machine, const Changes& changes, MeasuredRun run,
                     const Eigen::VectorXd& noise_sd, double bandwidth);

struct Prediction {
  std::vector<double> horizons;  ///< [s]
  struct Sensor {
    std::string channel;
    std::string unit;
    Eigen::VectorXd rms;  ///< of every horizon; infinite where one diverges
  };
  std::vector<Sensor> sensors;
};

/// Over one tick, 10 ms, 100 ms and 1 s, as far as those are longer than a tick and no more
/// than a quarter of the shortest record; from 200 moments of the run.
/// @param skip  samples at the start of every record that count for nothing
Prediction Predict(const Machine& machine, const FollowedRun& followed,
                   Eigen::Index skip);

}  // namespace mjdiag
