#pragma once
// Measured at irregular times, or by another clock than that of the controllers: the
// signals between their samples, on a uniform grid.

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/signals/fresh_samples.h"
#include "mjdiag/signals/uniform_time.h"

namespace mjdiag {

/// What a signal does between its samples.
enum class Course {
  kSmooth,    ///< a cubic through four samples: sensors, references
  kStraight,  ///< goes straight to the next one
  kHeld,      ///< keeps its sample, as the output of a controller does
  kSwitched   ///< the same, and has no values but those of its samples
};

/// Of a clock, a share: what is closer is the same.
inline constexpr double kSameClock = 1e-4;

struct Resampling {
  double sample_time = 0.0;               ///< wanted, the control tick [s]
  std::map<std::string, Course> courses;  ///< of channels; others are smooth
  /// Channels that sensors read: their repeats may be of a sensor that is slower.
  std::map<std::string, ReadingScale> readings{};
  /// A clock of the record's own that is off by less, a share of the wanted one, is kept.
  double own_clock = kSameClock;
};

/// Where the samples of a record are to be.
struct SampleGrid {
  UniformTime time;
  Eigen::Index samples = 0;
  /// Why they are not those of the file, for people; empty: they are.
  std::string note;

  bool IsOfFile() const { return note.empty(); }
};

/// The times themselves where they are uniform (FitUniformTime) and at the wanted rate, but
/// for a first one or two that a logger takes by themselves, which are left out;
/// else a grid of the wanted sample time from the first to the last of them, there in a tick
/// where most of them are.
/// @param times  [s], one a sample
/// @param place  where sample k stands, for messages
/// @param own_clock  as Resampling::own_clock
/// InputError: fewer than two samples, a time that is not after the one before it, and a
/// rate so far from the wanted one (30 times) that it must be in another unit.
SampleGrid ChooseGrid(const Eigen::VectorXd& times, double sample_time,
                      const std::function<std::string(Eigen::Index)>& place,
                      double own_clock = kSameClock);

/// The signal at the times of the grid. What is held becomes its mean over a tick, so that
/// an input has the same impulse; a switch has the value of the middle of the tick.
/// @param times  of `samples`, increasing
Eigen::VectorXd Resample(const Eigen::VectorXd& times, const Eigen::VectorXd& samples,
                         const SampleGrid& grid, Course course);

}  // namespace mjdiag
