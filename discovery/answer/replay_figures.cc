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

#include "mjdiag/plugin/replay/kept_gains.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kDiverged = std::numeric_limits<double>::infinity();

/// rms of measured minus simulated of records, samples first .. first + samples - 1.
/// @param samples  0: to the end
std::map<std::string, double> ChannelRms(
    const std::vector<const Comparison*>& comparisons, Index first, Index samples) {
  std::map<std::string, double> squares;
  std::map<std::string, double> counts;
  for (const Comparison* comparison : comparisons) {
    for (const ChannelMismatch& channel : comparison->channels) {
      const Channel& measured = comparison->measured.At(channel.name);
      const VectorXd difference =
          measured.samples - comparison->simulated.At(channel.name).samples;
      const Index n = samples > 0 ? samples : difference.size() - first;
      const VectorXd counted =
          measured.measured.size() == 0
              ? VectorXd(difference.segment(first, n))
              : Kept(difference.segment(first, n), measured.measured.segment(first, n));
      squares[channel.name] += counted.squaredNorm();
      counts[channel.name] += static_cast<double>(counted.size());
    }
  }
  for (auto& [name, square] : squares) square = std::sqrt(square / counts[name]);
  return squares;
}

/// 1 - after / before, of the root mean square over noise floor of all channels.
double GainOf(const std::map<std::string, double>& before,
              const std::map<std::string, double>& after,
              const std::map<std::string, double>& floor) {
  double was = 0.0;
  double is = 0.0;
  for (const auto& [channel, rms] : before) {
    const double scale = std::max(floor.at(channel), 1e-300);
    was += std::pow(rms / scale, 2);
    is += std::pow(after.at(channel) / scale, 2);
  }
  return was > 0.0 ? 1.0 - std::sqrt(is / was) : 0.0;
}

void AddMismatch(const Measurements& measurements, const Changes& changes, Index skip,
                 std::uint64_t seed, bool follows, Discovery& discovery) {
  discovery.records = ReplayAll(measurements, changes, seed, follows);
  const bool one = measurements.fit.size() == 1 && measurements.unseen.empty();
  const auto train = static_cast<Index>(
      std::lround(discovery.train_share *
                  static_cast<double>(measurements.fit.front().record.samples())));
  const Index first = std::min(skip, train - 1);
  const auto figures = [&](const Comparison RecordReplay::*model) {
    std::vector<const Comparison*> seen;
    std::vector<const Comparison*> unseen;
    for (const RecordReplay& replay : discovery.records) {
      (replay.seen ? seen : unseen).push_back(&(replay.*model));
    }
    return Discovery::Figures{
        ChannelRms(seen, first, one ? train - first : 0),
        unseen.empty() ? ChannelRms(seen, train, 0) : ChannelRms(unseen, first, 0)};
  };
  discovery.mismatch_before = figures(&RecordReplay::before);
  discovery.mismatch_after = figures(&RecordReplay::after);
  for (const ChannelMismatch& channel : discovery.Fitted()->after.channels) {
    discovery.noise_floor[channel.name] = channel.noise_floor.rms;
    discovery.unit[channel.name] = channel.unit;
  }
  SetGains(discovery);
}

VectorXd ScaledAlong(const AnswerData& data, const Model& model, const MeasuredRun& run,
                     const FilterPath& path, const KeptGains& gains) {
  try {
    return PredictAlong(data.With(model), run, path, gains);
  } catch (const NumericalError&) {
    return VectorXd::Constant(gains.rows(), kDiverged);
  }
}

/// Of samples from `first` on.
VectorXd Behind(const VectorXd& scaled, const KeptGains& gains, Index first) {
  const auto begin = std::ranges::find_if(
      gains.readings,
      [&](const KeptGains::Reading& one) { return one.sample >= first; });
  return scaled.tail(gains.readings.end() - begin);
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

void SetGains(Discovery& discovery) {
  discovery.gain_train = GainOf(discovery.mismatch_before.train,
                                discovery.mismatch_after.train, discovery.noise_floor);
  discovery.gain_validation =
      GainOf(discovery.mismatch_before.validation, discovery.mismatch_after.validation,
             discovery.noise_floor);
}

bool AddReplays(const Measurements& measurements, const Changes& changes, Index skip,
                std::uint64_t seed, Discovery& discovery) {
  const auto add = [&](bool follows) {
    AddMismatch(measurements, changes, skip, seed, follows, discovery);
  };
  const auto is_better = [&] {
    return discovery.gain_validation > 0.0 && discovery.gain_train > 0.0;
  };
  if (!AnyFalls(measurements)) {
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
        step.held_out = RmsOf(Behind(
            ScaledAlong(data, model, data.run.unseen, answer.unseen, unseen_gains),
            unseen_gains, data.run.first_unseen));
        return;
      default:
        break;
    }
    if (follows) return;
    const Changes changes = ChangesOf(data.blocks, model);
    const bool is_fit = number % kParts == 2;
    try {
      (is_fit ? step.error_percent : step.validation_percent) =
          MeanReplayErrors(is_fit ? measurements.fit : measurements.unseen, changes);
    } catch (const NumericalError&) {
      // It diverges so far, and has no error.
    }
  });
  const Index sensors = answer.seen.sensors();
  discovery.colour_before = ColourOf(scaled.front(), gains, sensors);
  discovery.colour_after = ColourOf(scaled.back(), gains, sensors);
}

}  // namespace mjdiag
