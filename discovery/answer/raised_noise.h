#pragma once
// White noise of sensors beyond what the setup says of them. With the causes found in
// the plant, innovations hold the noise of the sensors and nothing else, so that their
// standard deviation is the noise, to 1 / sqrt(2 n) of itself.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct RaisedNoise {
  std::string element;    ///< MJCF sensor
  std::string unit;       ///< of the channel
  double sd = 0.0;        ///< beside the setup's own, [unit]
  double sd_error = 0.0;  ///< its standard deviation
};

/// Sensors whose noise exceeds that of the setup by more than five standard deviations
/// of its estimate, and by more than a fiftieth. Sensors without noise in the setup are
/// left out: nothing is known of them. So are those that have less in the upper half of
/// the band than in all of it: what machines do beside their models is slow; and those in
/// which what is more is not there all the time: a model lacks something now and then, as
/// where a guide begins to slide.
/// @param measured  which innovations were, ny x samples; empty: all
std::vector<RaisedNoise> FindRaisedNoise(const Setup& setup, const Observer& observer,
                                         const Eigen::MatrixXd& innovations,
                                         double share,
                                         const Eigen::ArrayXX<bool>& measured = {});

}  // namespace mjdiag
