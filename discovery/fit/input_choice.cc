#include "mjdiag/discovery/fit/input_choice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/replay/input_noise.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::VectorXd;

namespace {

/// Of what is as measured a little smoothing says whether any is worth it.
constexpr double kLeastWidth = 2.0;  // ticks

/// Up to 50 ms: what a torque does below 3 Hz a machine feels.
std::vector<double> WidthsOf(const MeasuredRun& run) {
  constexpr double kLongest = 0.05;  // [s]
  std::vector<double> widths;
  for (double one = 1.0; one * run.sample_time <= kLongest; one *= 2.0) {
    widths.push_back(one);
  }
  return widths;
}

/// The likeliest of some widths.
InputChoice BestOf(const std::vector<double>& widths, const Machine& machine,
                   const MeasuredRun& run, const VectorXd& reading_sd,
                   const FilterPath& path, InputChoice best,
                   const IsTimeOver& is_over) {
  std::vector<std::optional<FilterPath>> paths(widths.size());
  ParallelForAll(static_cast<int>(widths.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    try {
      paths[i] = FilterLikeliestNear(machine, WithInputsOver(run, widths[i]),
                                     reading_sd, path.dofs, path.noise, is_over);
    } catch (const NumericalError&) {
    }
  });
  const auto cost = [](const FilterPath& one, double width) {
    return one.deviance + PriceOfWidth(width);
  };
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (!paths[i]) continue;
    if (cost(*paths[i], widths[i]) < cost(best.path, best.width)) {
      best = {widths[i], std::move(*paths[i])};
    }
  }
  return best;
}

}  // namespace

MeasuredRun WithInputsOver(const MeasuredRun& run, double width) {
  VectorXd widths = VectorXd::Zero(run.inputs.rows());
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    if (IsNoiseWithin(run.EveryInput().row(i).transpose(), run, width))
      widths[i] = width;
  }
  return WithSmoothedInputs(run, widths);
}

bool InputsAreNoise(const MeasuredRun& run) {
  return WithInputsOver(run, kLeastWidth).inputs != run.inputs;
}

double PriceOfWidth(double width) {
  constexpr double kWidths = 12.0;  // that may be
  return width == 0.0 ? 0.0 : kClaim + 2.0 * std::log(kWidths);
}

std::optional<InputChoice> ChooseInputs(const Machine& machine, const MeasuredRun& run,
                                        const VectorXd& reading_sd,
                                        const FilterPath& path, double width,
                                        const IsTimeOver& is_over) {
  const InputChoice as_it_is{width, path};
  const auto is_better = [&](const InputChoice& other) {
    return other.path.deviance + PriceOfWidth(other.width) <
           path.deviance + PriceOfWidth(width) - kLeastGain;
  };
  if (width == 0.0) {
    const MeasuredRun smoother = WithInputsOver(run, kLeastWidth);
    if (smoother.inputs == run.inputs) return std::nullopt;
    const FilterPath little =
        RunForceFilter(machine, smoother, path.dofs, path.starts, path.noise);
    if (little.deviance > path.deviance) return std::nullopt;
  }
  const std::vector<double> all = WidthsOf(run);
  std::vector<double> few{width == 0.0 ? kLeastWidth : 0.0};
  for (const double one : all) {
    if (one == 0.5 * width || one == 2.0 * width) few.push_back(one);
  }
  InputChoice best = BestOf(few, machine, run, reading_sd, path, as_it_is, is_over);
  if (!is_better(best)) return std::nullopt;
  if (width > 0.0 || is_over()) return best;
  std::vector<double> others = all;
  std::erase(others, kLeastWidth);
  return BestOf(others, machine, run, reading_sd, path, std::move(best), is_over);
}

}  // namespace mjdiag
