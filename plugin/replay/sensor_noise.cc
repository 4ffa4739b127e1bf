#include "mjdiag/plugin/replay/sensor_noise.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/signals/noise_level.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd SensorNoise(const Channels& channels, const MeasuredRun& run) {
  VectorXd sd(run.outputs.rows());
  for (Index i = 0; i < sd.size(); ++i) {
    const SensorSetup& sensor = channels.sensors[static_cast<std::size_t>(i)];
    // A signal without any noise leaves rounding.
    const double rounding = 1e-12 * run.outputs.row(i).cwiseAbs().maxCoeff();
    sd[i] = std::max({NoiseLevel(run.ReadingsOf(i)),
                      sensor.resolution / std::sqrt(12.0), rounding, 1e-15});
  }
  return sd;
}

}  // namespace mjdiag
