#include "mjdiag/discovery/fit/first_look.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/plugin/machine/plant_state.h"
#include "mjdiag/plugin/replay/coarser_run.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/noise_search.h"

namespace mjdiag {

using Eigen::Index;

FirstLook FirstLookAt(const Machine& machine, const MeasuredRun& whole,
                      const Eigen::VectorXd& reading_sd) {
  constexpr double kPart = 0.25;
  constexpr double kReadings = 2500.0;
  constexpr double kSteps = 10000.0;
  const auto samples = static_cast<double>(whole.samples());
  const double steps = samples * static_cast<double>(machine.rates().substeps);
  const std::vector<Index> dofs = LatentDofs(machine, whole);
  const double share = std::clamp(kSteps / steps, kPart, 1.0);
  FirstLook look{PiecesOfRun(machine, whole, dofs, share), true, 1};
  if (2 * look.run.samples() > whole.samples()) look = {whole, false, 1};
  // As many as tell a noise.
  const Index states = TangentSize(machine.plant()) + std::ssize(dofs) + 1;
  const auto enough = static_cast<double>(EnoughOf(whole.outputs.rows(), states));
  const double readings = std::min(kReadings, std::max(kPart * samples, enough));
  look.ticks = TicksThatShowMotion(look.run, reading_sd, static_cast<Index>(readings));
  return look;
}

bool TellsMoreInBetween(const FilterPath& path) {
  constexpr double kMost = 2.0;  // times what the noise of the reading is
  for (Index i = 0; i < path.sensors(); ++i) {
    const auto counted = static_cast<double>(path.counts.row(i).count());
    if (path.innovations.row(i).squaredNorm() <
        kMost * counted * std::pow(path.noise.reading[i], 2)) {
      return true;
    }
  }
  return false;
}

FilterNoise NoiseInTicksOf(const FilterPath& path, double sample_time) {
  FilterNoise noise = path.noise;
  noise.white *= std::sqrt(path.sample_time / sample_time);
  return noise;
}

}  // namespace mjdiag
