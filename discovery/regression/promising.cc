#include "mjdiag/discovery/regression/promising.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "mjdiag/discovery/regression/wave_sums.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// White noises that measure how large a column is: to a quarter of it.
constexpr Index kProbes = 32;
constexpr std::size_t kOfBlock = 3;
// Of a group, which are alike.
constexpr std::size_t kOfGroup = 4;

MatrixXd WhiteNoise(Index rows, Index columns) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

struct Promise {
  double gain = 0.0;
  Variation variation;
};

/// Of the period or the frequency of a block.
std::pair<double, double> BoundsOf(const Block& block) {
  const FitParameter& period =
      block.candidate
          ->parameters[static_cast<std::size_t>(PeriodPlace(*block.candidate))];
  return {period.lower, period.upper};
}

/// Where the waves of a sweep act, with an amplitude of 1.
Column WavesOf(const Sweep& sweep, const Block& block) {
  Column column;
  const Trial trial = sweep.make(sweep.value(0));
  const VectorXd one = VectorXd::Ones(trial.signals.rows());
  if (trial.entry.size() == 0) {
    column.readings.emplace_back(block.candidate->channel, one);
  }
  for (Index dof = 0; dof < trial.entry.rows(); ++dof) {
    if (trial.entry(dof, 0) == 0.0) continue;
    column.forces.emplace_back(dof, trial.entry(dof, 0) * one);
  }
  return column;
}

}  // namespace

std::vector<Variation> PromisingVariations(
    const Machine& machine, const BlockMotion& along, const RowMap& map,
    const VectorXd& left, const MatrixXd& W, const VectorXd& sd,
    std::vector<Block>& blocks, const std::function<bool(const Block&)>& may_come) {
  const Index k = W.cols();
  MatrixXd u(W.rows(), 1 + k + kProbes);
  u << left, W, WhiteNoise(W.rows(), kProbes);
  const auto transposed = map.TransposedTimes(u);
  Eigen::LLT<MatrixXd> H;
  if (k > 0) {
    MatrixXd G = W.transpose() * W;
    G.diagonal() += sd.cwiseAbs2().cwiseInverse();
    H.compute(G);
  }
  /// How much columns take away of what the model leaves, in -2 ln, by their products with
  /// u, in units of what is known of their amplitudes.
  const auto gain_of = [&](const MatrixXd& products) {
    const Index m = products.cols();
    const VectorXd b = products.row(0).transpose();
    const auto probed = products.bottomRows(kProbes);
    MatrixXd G = probed.transpose() * probed / static_cast<double>(kProbes);
    if (k > 0) {
      const MatrixXd cross = products.middleRows(1, k);
      const MatrixXd shared = cross.transpose() * H.solve(cross);
      // What the set can do itself is known only as well as the probes measure.
      G -= 0.9 * shared;
    }
    G.diagonal().array() = G.diagonal().array().max(0.0) + 1.0;
    const Eigen::LLT<MatrixXd> solved(G);
    if (solved.info() != Eigen::Success || !b.allFinite()) return 0.0;
    return b.head(m).dot(solved.solve(b));
  };
  const auto products_of = [&](const Variation& one) {
    const Index m = one.sd.size();
    MatrixXd products(u.cols(), m);
    for (Index a = 0; a < m; ++a) {
      for (Index j = 0; j < u.cols(); ++j) {
        products(j, a) = one.sd[a] * transposed[static_cast<std::size_t>(j)].Times(
                                         one.columns[static_cast<std::size_t>(a)]);
      }
    }
    return products;
  };
  std::vector<std::vector<Promise>> promises(blocks.size());
  ParallelFor(static_cast<int>(blocks.size()), [&](int number) {
    const auto place = static_cast<std::size_t>(number);
    std::vector<Promise>& best = promises[place];
    const auto take = [&](double gain, Variation&& one) {
      if (best.size() == kOfBlock && gain <= best.back().gain) return;
      best.push_back({gain, std::move(one)});
      std::ranges::sort(best, std::greater<>(), &Promise::gain);
      if (best.size() > kOfBlock) best.pop_back();
    };
    Block& block = blocks[place];
    if (!may_come(block)) return;
    const std::optional<Sweep> sweep = SweepOf(machine, along, block);
    if (!sweep) {
      ForEachVariation(machine, along, place, block, [&](Variation&& one) {
        const double gain = gain_of(products_of(one));
        take(gain, std::move(one));
      });
      return;
    }
    const auto [lowest, highest] = BoundsOf(block);
    const BlockScales scales = ScalesOf(machine, along, block);
    const auto of_shape = [&](Index m) {
      return VariationOf(place, block, scales, sweep->make(sweep->value(m)),
                         static_cast<std::size_t>(m));
    };
    const Variation first = of_shape(0);
    block.price = PriceOf(block, sweep->count);
    if (first.columns.empty()) return;
    // Of every period at once: the sine and the cosine times u.
    Eigen::MatrixXcd sums(sweep->count, u.cols());
    for (Index j = 0; j < u.cols(); ++j) {
      sums.col(j) = WaveSums(
          transposed[static_cast<std::size_t>(j)].Along(WavesOf(*sweep, block)),
          sweep->angle, sweep->increment, sweep->count);
    }
    VectorXd gains(sweep->count);
    for (Index m = 0; m < sweep->count; ++m) {
      const double value = sweep->value(m);
      if (value < lowest || value > highest) {
        gains[m] = 0.0;
        continue;
      }
      MatrixXd products(u.cols(), 2);
      products.col(0) = first.sd[0] * sums.row(m).imag().transpose();
      products.col(1) = first.sd[1] * sums.row(m).real().transpose();
      gains[m] = gain_of(products);
    }
    for (Index m = 0; m < gains.size(); ++m) {
      const double before = m > 0 ? gains[m - 1] : 0.0;
      const double after = m + 1 < gains.size() ? gains[m + 1] : 0.0;
      if (gains[m] <= before || gains[m] < after) continue;
      if (best.size() == kOfBlock && gains[m] <= best.back().gain) continue;
      take(gains[m], of_shape(m));
    }
  });
  std::vector<Promise> all;
  for (std::size_t place = 0; place < promises.size(); ++place) {
    for (Promise& one : promises[place]) {
      if (one.gain > 0.5 * blocks[place].price) all.push_back(std::move(one));
    }
  }
  std::ranges::stable_sort(all, std::greater<>(), &Promise::gain);
  std::map<std::string, std::size_t> of_group;
  std::vector<Variation> kept;
  for (Promise& one : all) {
    const std::string& group = blocks[one.variation.block].group;
    if (!group.empty() && ++of_group[group] > kOfGroup) continue;
    kept.push_back(std::move(one.variation));
  }
  return kept;
}

}  // namespace mjdiag
