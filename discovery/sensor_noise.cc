#include "mjdiag/discovery/sensor_noise.h"

#include <cmath>

namespace mjdiag {

std::vector<RaisedNoise> FindRaisedNoise(const Setup& setup, const Observer& observer,
                                         const Eigen::MatrixXd& innovations,
                                         double share) {
  using Eigen::Index;
  constexpr double kSigmas = 5.0;
  constexpr double kLeast = 0.02;
  const auto n = static_cast<Index>(share * static_cast<double>(innovations.cols()));
  std::vector<RaisedNoise> found;
  for (std::size_t i = 0; i < setup.sensors.size(); ++i) {
    const SensorSetup& sensor = setup.sensors[i];
    const auto row = static_cast<Index>(i);
    const double expected =
        std::hypot(sensor.noise_sd, sensor.resolution / std::sqrt(12.0));
    if (sensor.noise_sd <= 0.0 || n < 2) continue;
    // What the observer makes of white noise of unit standard deviation.
    const double colouring = observer.innovation_sd[row] / observer.noise_sd[row];
    const double rms =
        std::sqrt(innovations.row(row).head(n).squaredNorm() / static_cast<double>(n)) /
        colouring;
    const double error = rms / std::sqrt(2.0 * static_cast<double>(n));
    if (rms - expected < std::max(kSigmas * error, kLeast * expected)) continue;
    const double raised = std::sqrt(rms * rms - expected * expected);
    found.push_back({sensor.element, sensor.unit, raised, error * rms / raised});
  }
  return found;
}

}  // namespace mjdiag
