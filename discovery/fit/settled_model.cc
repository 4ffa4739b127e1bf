#include "mjdiag/discovery/fit/settled_model.h"

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

SettledModel Settle(const MachineWith& machine_with, const MeasuredRun& run,
                    const Eigen::VectorXd& reading_sd,
                    const std::vector<Eigen::Index>& dofs,
                    const std::vector<Block>& blocks, ModelFit fit,
                    const std::vector<FilterNoise>& near, double beat, double hoped,
                    const std::function<bool()>& is_over) {
  SettledModel settled{std::move(fit), {}};
  // Values of first order are off, and what sticks by them a fit may free; what is so much
  // further off than it was to gain is nonsense.
  constexpr double kNonsense = 300.0;
  const auto is_nonsense = [&] {
    return settled.score() - beat > kNonsense * std::max(hoped, kLeastGain);
  };
  const Machine first = machine_with(settled.fit.model);
  try {
    settled.path = RunForceFilter(first, run, dofs,
                                  FilterStarts(first, run, reading_sd), near.back());
    if (is_nonsense()) return settled;
  } catch (const NumericalError&) {
  }
  settled.path = FilterLikeliestFrom(first, run, reading_sd, dofs, near);
  // Values that are off make latent forces large, behind which values are hardly seen:
  // where fits behind the noise of the last filter gain no more, one behind a smaller may.
  constexpr int kRounds = 6;
  constexpr std::size_t kSmaller = 2;  // of NoisesFrom
  std::size_t smaller = 0;
  if (is_nonsense()) return settled;
  for (int round = 0; round < kRounds && !is_over(); ++round) {
    if (settled.fit.model.empty()) break;
    const FilterPath& path = settled.path;
    const std::vector<FilterNoise> noises = NoisesFrom(path.noise);
    const KeptGains gains = KeepGains(path, noises[smaller], InflationAlong(path));
    double gain = 0.0;
    try {
      const MachineWith in_time = InTime(machine_with, is_over);
      const FitOf fitted = [&](const Model& start) {
        return FitModel(in_time, run, path, gains, blocks, start, 4);
      };
      SettledModel next{Pruned(blocks, fitted(settled.fit.model), fitted), {}};
      // Where a fit gains nothing behind the gains that it was made behind, a filter, which
      // takes longer, need not be asked.
      const double before =
          gains.left.squaredNorm() + gains.log_determinant + settled.fit.prior;
      if (next.fit.model.size() != settled.fit.model.size() ||
          before - next.fit.deviance - next.fit.prior > kLeastGain) {
        const Machine machine = machine_with(next.fit.model);
        next.path = smaller > 0 ? FilterLikeliestFrom(machine, run, reading_sd, dofs,
                                                      {path.noise, noises[smaller]})
                                : FilterLikeliestNear(machine, run, reading_sd, dofs,
                                                      path.noise);
        gain = settled.score() - next.score();
        if (gain > 0.0) settled = std::move(next);
      }
    } catch (const NumericalError&) {
    }
    if (gain < kLeastGain && smaller == kSmaller) break;
    smaller = gain < kLeastGain ? kSmaller : 0;
  }
  return settled;
}

}  // namespace mjdiag
