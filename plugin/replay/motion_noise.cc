#include "mjdiag/plugin/replay/motion_noise.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/replay/observer.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// By its median, of values of mean 0.
double SpreadOf(VectorXd values) {
  if (values.size() == 0) return 0.0;
  values = values.cwiseAbs().eval();
  const Index middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + middle, values.end());
  return values[middle] / 0.67448975;
}

}  // namespace

double FastestBandwidth(const Machine& machine, const MeasuredRun& run) {
  constexpr double kShare = 0.15;
  Index period = 1;
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    period = std::max(period, run.PeriodOf(i));
  }
  return kShare * machine.rates().control / static_cast<double>(period);
}

VectorXd NoiseInMotion(const Machine& machine, const MeasuredRun& run,
                       const VectorXd& noise_sd,
                       const std::shared_ptr<const MotionPath>& path) {
  const Observer observer =
      DesignObserver(machine, run, noise_sd, FastestBandwidth(machine, run), path);
  const Track track = FollowRun(machine, {}, run, observer, false);
  VectorXd sd = noise_sd;
  for (Index i = 0; i < sd.size(); ++i) {
    const double seen =
        SpreadOf(Kept(track.innovations.row(i), run.CountedOf(i, 0, run.samples())));
    const double expected = std::sqrt(observer.innovation_covariance(i, i));
    sd[i] *= std::max(1.0, seen / expected);
  }
  return sd;
}

}  // namespace mjdiag
