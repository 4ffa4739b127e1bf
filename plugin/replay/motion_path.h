#pragma once
// The first order of a machine along a measured motion, for machines that leave the
// neighbourhood of their rest: joints that turn by a radian, plants that fall.
//
// The readings y say the configuration: joint positions with g(q) = y, from one moment to
// the next by the step that strains springs least (start_state.h). Positions, velocities
// and accelerations are those of the quadratic polynomial of least squares through the
// readings about a moment (A. Savitzky, M. J. E. Golay, "Smoothing and Differentiation of
// Data by Simplified Least Squares Procedures", Analytical Chemistry 36, 1964). M, D, K,
// Gamma and b of deviations from that motion (MotionLinearization) hold for a stretch of a
// hundredth of a second, in which a joint at 3 rad/s turns by 30 mrad.
//
// All of it is a property of the record and of the nominal machine. It does not depend on
// what is tried beside the record, so that an observer on it is the same for all
// hypotheses.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

struct MeasuredRun;

struct MotionPath {
  struct Stretch {
    Eigen::Index first = 0;  ///< sample
    MechanicalModel model;
    StateSpace tick;  ///< of the model, x = [q; v]
  };
  std::vector<Stretch> stretches;  ///< in order; each record begins with one of its own
  std::vector<std::size_t> of_sample;        ///< which stretch every sample is in
  std::vector<std::size_t> first_stretches;  ///< of every record
  std::vector<MotionPoint> starts;           ///< where every record begins
};

/// Joint positions, velocities and accelerations of a run at some of its samples, as the
/// readings say. Empty if they do not say it: if no configuration gives the readings.
/// @param samples  in order
std::vector<MotionPoint> MotionOfReadings(const Machine& machine,
                                          const MeasuredRun& run,
                                          const std::vector<Eigen::Index>& samples);

/// The first order along the run, null if its readings do not say the configuration.
std::shared_ptr<const MotionPath> PathAlong(const Machine& machine,
                                            const MeasuredRun& run);

/// Whether an observer of that bandwidth [Hz] may take the machine as what it is at rest.
/// With w = 2 pi bandwidth and differences between rest and 64 moments of the run,
///
///   |dM| < 0.1,   |dK| < w^2 / 2,   |dD| < w / 2       in coordinates of unit mass,
///   |db| < 0.1 of the largest entry:
///
/// what pulls the observer back is more than what the machine does by itself. True if the
/// readings do not say the configuration.
bool RestGainHolds(const Machine& machine, const MeasuredRun& run, double bandwidth);

}  // namespace mjdiag
