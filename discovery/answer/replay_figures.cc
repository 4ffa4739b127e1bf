#include "mjdiag/discovery/answer/replay_figures.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/mismatch_figures.h"
#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kDiverged = std::numeric_limits<double>::infinity();

void AddMismatch(const Measurements& measurements, const Changes& changes,
                 PhysicsSteps steps, Index skip, std::uint64_t seed, bool follows,
                 const FilterNoise& near, Discovery& discovery) {
  discovery.records = ReplayAll(measurements, changes, steps, seed, follows, near);
  AddMismatchFigures(skip, discovery);
}

VectorXd ScaledAlong(const AnswerData& data, const Model& model, const MeasuredRun& run,
                     const FilterPath& path, const KeptGains& gains) {
  try {
    return PredictAlong(data.With(model), run, path, gains);
  } catch (const NumericalError&) {
    return VectorXd::Constant(gains.rows(), kDiverged);
  }
}

/// Of some samples.
VectorXd Of(const VectorXd& scaled, const KeptGains& gains, const SampleMask& samples) {
  SampleMask counts(scaled.size());
  for (Index row = 0; row < scaled.size(); ++row) {
    counts[row] = samples[gains.readings[static_cast<std::size_t>(row)].sample];
  }
  return Kept(scaled, counts);
}

double RmsOf(const VectorXd& scaled) {
  return scaled.size() > 0
             ? std::sqrt(scaled.squaredNorm() / static_cast<double>(scaled.size()))
             : 0.0;
}

/// Share of the power of innovations of each sensor that its last ten predict, the mean of
/// all: 0 of white noise, but for ten over how many there are.
double ColourOf(const VectorXd& scaled, const KeptGains& gains, Index sensors) {
  constexpr Index kOrder = 10;
  if (!scaled.allFinite()) return 1.0;
  double sum = 0.0;
  for (Index s = 0; s < sensors; ++s) {
    std::vector<double> own;
    for (Index row = 0; row < scaled.size(); ++row) {
      if (gains.readings[static_cast<std::size_t>(row)].sensor == s) {
        own.push_back(scaled[row]);
      }
    }
    const VectorXd z = VectorXd::Map(own.data(), std::ssize(own));
    const Index n = z.size() - kOrder;
    if (n < 5 * kOrder) continue;
    Eigen::MatrixXd past(n, kOrder);
    for (Index lag = 1; lag <= kOrder; ++lag) {
      past.col(lag - 1) = z.segment(kOrder - lag, n);
    }
    const Eigen::MatrixXd gram =
        past.transpose() * past +
        1e-9 * past.squaredNorm() * Eigen::MatrixXd::Identity(kOrder, kOrder);
    const VectorXd weights = gram.ldlt().solve(past.transpose() * z.tail(n));
    const double all = z.tail(n).squaredNorm();
    if (all > 0.0) {
      sum +=
          std::clamp(1.0 - (z.tail(n) - past * weights).squaredNorm() / all, 0.0, 1.0);
    }
  }
  return sum / static_cast<double>(std::max<Index>(1, sensors));
}

}  // namespace

bool AddReplays(const Measurements& measurements, const Changes& changes,
                PhysicsSteps steps, Index skip, std::uint64_t seed,
                const FilterNoise& near, Discovery& discovery) {
  const auto add = [&](bool follows) {
    AddMismatch(measurements, changes, steps, skip, seed, follows, near, discovery);
  };
  const auto is_better = [&] {
    return discovery.gain_validation > 0.0 && discovery.gain_train > 0.0;
  };
  if (!AnyDivergesOpenLoop(measurements)) {
    try {
      add(false);
      if (changes == Changes{} || is_better()) return false;
    } catch (const NumericalError&) {
      // With the changes it falls.
    }
  }
  add(true);
  return true;
}

void AddLadderOf(const AnswerData& data, const UnseenJudgement& judged,
                 const Measurements& measurements, bool follows, Discovery& discovery) {
  const ModelOnRuns& answer = judged.answer;
  const KeptGains gains = KeepGains(answer.seen);
  const KeptGains unseen_gains = KeepGains(answer.unseen);
  std::vector<std::size_t> order(answer.fit.model.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](std::size_t m) { return judged.losses[m].Total(); });
  std::vector<std::pair<std::string, Model>> steps = {{"nothing", {}}};
  for (const std::size_t m : order) {
    Model next = steps.back().second;
    next.push_back(answer.fit.model[m]);
    steps.emplace_back(data.blocks[answer.fit.model[m].block].name, std::move(next));
  }
  discovery.ladder.resize(steps.size());
  std::vector<VectorXd> scaled(steps.size());
  constexpr int kParts = 4;
  ParallelFor(kParts * static_cast<int>(steps.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / kParts);
    const auto& [name, model] = steps[i];
    LadderStep& step = discovery.ladder[i];
    switch (number % kParts) {
      case 0:
        step.added = name;
        scaled[i] = ScaledAlong(data, model, data.run.seen, answer.seen, gains);
        step.train = RmsOf(scaled[i]);
        return;
      case 1:
        step.held_out = RmsOf(
            Of(ScaledAlong(data, model, data.run.unseen, answer.unseen, unseen_gains),
               unseen_gains, data.run.New()));
        return;
      default:
        break;
    }
    if (follows) return;
    const Changes changes = ChangesOfModel(data.blocks, model);
    const bool is_fit = number % kParts == 2;
    try {
      (is_fit ? step.error_percent : step.validation_percent) = MeanReplayErrors(
          is_fit ? measurements.fit : measurements.unseen, changes, data.steps);
    } catch (const NumericalError&) {
      // It diverges so far, and has no error.
    }
  });
  const Index sensors = answer.seen.sensors();
  discovery.colour_before = ColourOf(scaled.front(), gains, sensors);
  discovery.colour_after = ColourOf(scaled.back(), gains, sensors);
}

}  // namespace mjdiag
