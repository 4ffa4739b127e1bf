#include "mjdiag/discovery/fit/input_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/fit/tick_columns.h"
#include "mjdiag/discovery/regression/fold_gram.h"
#include "mjdiag/plugin/replay/input_noise.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kFolds = 20;
constexpr std::array kWidths{0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0};

/// So many ticks later; the first of a record lasts.
VectorXd Later(const VectorXd& signal, const MeasuredRun& run, Index ticks) {
  VectorXd later(signal.size());
  for (std::size_t record = 0; record < run.records.size(); ++record) {
    const Index first = run.records[record].sample;
    const Index end = first + run.SamplesOf(record);
    for (Index k = first; k < end; ++k) later[k] = signal[std::max(first, k - ticks)];
  }
  return later;
}

/// Behind a first-order lag of that time constant [ticks].
VectorXd Lagging(const VectorXd& signal, const MeasuredRun& run, double ticks) {
  const double rest = std::exp(-1.0 / ticks);
  VectorXd lagging(signal.size());
  for (std::size_t record = 0; record < run.records.size(); ++record) {
    const Index first = run.records[record].sample;
    double now = signal[first];
    for (Index k = first; k < first + run.SamplesOf(record); ++k) {
      now = rest * now + (1.0 - rest) * signal[k];
      lagging[k] = now;
    }
  }
  return lagging;
}

/// Of the widths, those below 50 ms: what a torque does below 3 Hz a machine feels.
bool IsNoise(double width, const MeasuredRun& run) {
  constexpr double kLongest = 0.05;  // [s]
  return width * run.sample_time <= kLongest;
}

/// What an input may be instead of what was measured. One that comes late is smooth, too,
/// and no noise: where that says as much, the input stays.
std::vector<std::function<VectorXd(const VectorXd&)>> WaysOf(const MeasuredRun& run) {
  std::vector<std::function<VectorXd(const VectorXd&)>> ways;
  for (const double width : kWidths) {
    if (!IsNoise(width, run)) break;
    ways.emplace_back(
        [&run, width](const VectorXd& u) { return Smoothed(u, run, width); });
  }
  for (const double width : kWidths) {
    if (width == 0.0) continue;
    ways.emplace_back([&run, width](const VectorXd& u) {
      return Later(u, run, static_cast<Index>(width));
    });
    ways.emplace_back(
        [&run, width](const VectorXd& u) { return Lagging(u, run, width); });
  }
  return ways;
}

/// What may be missing whatever the inputs are: resistances of every joint in one size.
struct Resistances {
  std::vector<Column> columns;
  std::vector<double> sd;
};
Resistances ResistancesOf(const Machine& machine, const MeasuredRun& run,
                          const FilterPath& path, const std::vector<Block>& blocks) {
  const BlockMotion along{MotionAlong(machine, run, path), path.noise.reading,
                          run.Time().maxCoeff()};
  Resistances all;
  for (std::size_t place = 0; place < blocks.size(); ++place) {
    if (!blocks[place].IsResistance() || !blocks[place].IsSimplest()) continue;
    Block block = blocks[place];  // its price is another's business
    ForEachVariation(machine, along, place, block, [&](Variation&& one) {
      for (std::size_t i = 0; i < one.columns.size(); ++i) {
        all.columns.push_back(std::move(one.columns[i]));
        all.sd.push_back(one.sd[static_cast<Index>(i)]);
      }
    });
  }
  return all;
}

}  // namespace

double PriceOfWidths(const VectorXd& widths) {
  const double one = kClaim + 2.0 * std::log(static_cast<double>(kWidths.size() - 1));
  return one * static_cast<double>((widths.array() > 0.0).count());
}

InputChoice ChooseInputs(const Machine& machine, const MeasuredRun& run,
                         const FilterPath& path, const Whitenings& whitenings,
                         const VectorXd& widths, const std::vector<Block>& blocks) {
  const MeasuredRun smoothed = WithSmoothedInputs(run, widths);
  // What an input does in a tick goes with it: smoothed, it is what the smoothed one does.
  std::vector<MeasuredRun> without;
  for (Index i = 0; i < widths.size(); ++i) {
    without.push_back(run);
    without.back().inputs = smoothed.inputs;
    without.back().inputs.row(i).setZero();
  }
  std::vector<MeasuredRun> as_measured;
  std::vector<OtherMachine> others;
  for (Index i = 0; i < widths.size(); ++i) {
    as_measured.push_back(smoothed);
    as_measured.back().inputs.row(i) = run.inputs.row(i);
  }
  for (const MeasuredRun& one : without) others.push_back({machine, 1.0, &one});
  for (const MeasuredRun& one : as_measured) others.push_back({machine, 1.0, &one});
  const std::vector<Column> columns = TickColumns(machine, smoothed, path, others);
  const auto ways = WaysOf(run);
  const auto smooth = static_cast<std::size_t>(std::ranges::count_if(
      kWidths, [&](double width) { return IsNoise(width, run); }));
  const auto count = static_cast<Index>(ways.size());
  std::vector<Column> changes;
  for (Index i = 0; i < widths.size(); ++i) {
    const Column& off = columns[static_cast<std::size_t>(i)];
    const Column& raw = columns[static_cast<std::size_t>(widths.size() + i)];
    const auto signal_of = [&](const Column& of, Index state) -> VectorXd {
      for (const auto& [at, signal] : of.states) {
        if (at == state) return signal;
      }
      return VectorXd::Zero(path.samples());
    };
    for (const auto& way : ways) {
      Column change;
      for (const auto& [state, signal] : off.states) {
        const VectorXd from_raw = signal_of(raw, state) - signal;  // of the raw input
        change.states.emplace_back(state, way(from_raw) + signal);
      }
      changes.push_back(std::move(change));
    }
  }
  std::vector<const Column*> all;
  for (const Column& one : changes) all.push_back(&one);
  SetOfColumns beside;
  const Resistances resistances = ResistancesOf(machine, smoothed, path, blocks);
  std::vector<double> sd = resistances.sd;
  for (const Column& one : resistances.columns) all.push_back(&one);
  for (Index i = 0; i < widths.size(); ++i) {
    all.push_back(&columns[static_cast<std::size_t>(i)]);
    sd.push_back(1.0);  // nothing, or twice as much
  }
  for (std::size_t i = changes.size(); i < all.size(); ++i) {
    beside.columns.push_back(static_cast<Index>(i));
  }
  beside.sd = VectorXd::Map(sd.data(), std::ssize(sd));
  beside.mean = VectorXd::Zero(beside.sd.size());
  InputChoice best{widths, path.noise};
  double best_score = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < whitenings.behind.size(); ++r) {
    const FoldGram gram = GramOf(whitenings.behind[r], all, kFolds);
    VectorXd chosen = widths;
    std::vector<Index> place(static_cast<std::size_t>(widths.size()), -1);
    const auto score = [&] {
      SetOfColumns set = beside;
      for (const Index column : place) {
        if (column >= 0) set.given.push_back(column);
      }
      return FitSet(gram, set).unseen + PriceOfWidths(chosen);
    };
    double own = score();
    for (Index i = 0; i < widths.size(); ++i) {
      const Index before = place[static_cast<std::size_t>(i)];
      const double width_before = chosen[i];
      Index best_place = before;
      double best_width = width_before;
      for (Index w = 0; w < count; ++w) {
        place[static_cast<std::size_t>(i)] = i * count + w;
        const auto way = static_cast<std::size_t>(w);
        chosen[i] = way < smooth ? kWidths[way] : 0.0;
        const double one = score();
        if (one < own) {
          own = one;
          best_place = i * count + w;
          best_width = chosen[i];
        }
      }
      place[static_cast<std::size_t>(i)] = best_place;
      chosen[i] = best_width;
    }
    if (own < best_score) {
      best_score = own;
      best = {chosen, whitenings.noises[r]};
    }
  }
  return best;
}

}  // namespace mjdiag
