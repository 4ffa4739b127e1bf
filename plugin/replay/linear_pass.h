#pragma once
// A filter with another noise along a path (force_filter.h): the linear one of deviations
// from the path, driven by what the path was pulled by.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/force_kalman.h"

namespace mjdiag {

/// Over samples first .. first + count - 1, `first` where a record begins or the filter is
/// started anew. What is called may look at `kalman`; all may be empty.
class LinearPass {
 public:
  LinearPass(const FilterPath& path, const FilterNoise& noise)
      : kalman(path.dofs, noise, path.sample_time), path_(path) {}

  void Over(Eigen::Index first, Eigen::Index count);

  /// Before the readings of a tick.
  std::function<void(Eigen::Index sample)> at_tick;
  /// After each.
  /// @param late      read at the end of the tick of the sample before it
  /// @param deviance  its part of -2 ln L
  std::function<void(Eigen::Index sensor, Eigen::Index sample, bool late,
                     double deviance)>
      at_reading;
  /// After all of a tick, and before it.
  std::function<void(Eigen::Index sample)> at_advance;
  /// How many times its variance a reading has, ny x samples; null: as the pass itself
  /// finds it, by Huber's corner.
  const Eigen::MatrixXd* inflation = nullptr;
  ForceKalman kalman;

 private:
  void Take(Eigen::Index sensor, bool late, Eigen::Index sample);

  const FilterPath& path_;
};

/// What a linear pass over a path keeps of every tick, for a smoother; in the order in which
/// readings were taken.
struct FilterGains {
  Eigen::MatrixXd K;      ///< (ns + nf + 1) x ny, 0 where nothing was measured
  Eigen::VectorXd S;      ///< ny
  Eigen::VectorXd e;      ///< ny, innovations
  Eigen::MatrixXd P;      ///< rows of [w; t] of the covariance before the readings
  Eigen::VectorXd force;  ///< w before the readings, nf
};

/// Of some of a run's samples behind another noise, along a path.
/// @param count  as LinearPass::Over
std::vector<FilterGains> GainsAlong(const FilterPath& path, const FilterNoise& noise,
                                    Eigen::Index first, Eigen::Index count);

/// What a linear pass over a path says of every sensor, ny.
struct ReadingScores {
  Eigen::VectorXd deviance;  ///< its part of -2 ln L
  Eigen::VectorXd variance;  ///< geometric mean of S
};

/// The same.
/// @param inflation  as LinearPass::inflation
ReadingScores Score(const FilterPath& path, const FilterNoise& noise,
                    Eigen::Index first, Eigen::Index count,
                    const Eigen::MatrixXd* inflation = nullptr);

}  // namespace mjdiag
