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

// White noises that measure how large a column is: to a third of it.
constexpr Index kProbes = 16;
constexpr double kUncertain = 1.5;  // times what a gain may be by that
constexpr std::size_t kOfBlock = 3;
// Of a group, which are alike.
constexpr std::size_t kOfGroup = 4;
// Blocks that could be in the place of a member, each in its best shape: a fit finds others.
constexpr std::size_t kInPlace = 8;

MatrixXd WhiteNoise(Index rows, Index columns) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

/// Products of columns with what models leave, with the columns of the model and with
/// white noises.
struct Products {
  Products(const RowMap& map, const MatrixXd& W,
           const std::vector<WhitenedModel>& models)
      : u(W.rows(), std::ssize(models) + W.cols() + kProbes),
        first_of_W(std::ssize(models)) {
    for (Index i = 0; i < first_of_W; ++i) {
      u.col(i) = models[static_cast<std::size_t>(i)].left;
    }
    u.rightCols(W.cols() + kProbes) << W, WhiteNoise(W.rows(), kProbes);
    transposed = map.TransposedTimes(u);
    of_W = u.transpose() * W;
  }

  /// u^T times columns in units of what is known of their amplitudes.
  MatrixXd Of(const Variation& one) const {
    const Index m = one.sd.size();
    MatrixXd products(u.cols(), m);
    for (Index a = 0; a < m; ++a) {
      for (Index j = 0; j < u.cols(); ++j) {
        products(j, a) = one.sd[a] * transposed[static_cast<std::size_t>(j)].Times(
                                         one.columns[static_cast<std::size_t>(a)]);
      }
    }
    return products;
  }

  MatrixXd u;
  Index first_of_W;
  std::vector<RowMap::Transposed> transposed;  // W^T u of the map
  MatrixXd of_W;                               // u^T W
};

/// How much columns take away of what a model leaves, in -2 ln, by their products.
class PromiseBeside {
 public:
  /// @param place  of the model
  PromiseBeside(const WhitenedModel& model, Index place, const Products& products,
                const VectorXd& sd)
      : place_(place) {
    for (const Index i : model.in) in_.push_back(products.first_of_W + i);
    if (!in_.empty()) {
      MatrixXd H = products.of_W(in_, model.in);
      H.diagonal() += VectorXd(sd(model.in)).cwiseAbs2().cwiseInverse();
      H_.compute(H);
    }
    if (model.removed.empty()) return;
    // Gains are known to a third.
    least_ = 0.5 * Gain(products.of_W(Eigen::indexing::all, model.removed) *
                        VectorXd(sd(model.removed)).asDiagonal());
  }

  /// Of what could be in the place of members, by what those do.
  double least() const { return least_; }

  /// @param products  u^T times columns
  double Gain(const MatrixXd& products) const {
    const Index m = products.cols();
    const VectorXd b = products.row(place_).transpose();
    const auto probed = products.bottomRows(kProbes);
    MatrixXd G = probed.transpose() * probed / static_cast<double>(kProbes);
    if (!in_.empty()) {
      const MatrixXd cross = products(in_, Eigen::indexing::all);
      const MatrixXd shared = cross.transpose() * H_.solve(cross);
      // What the set can do itself is known only as well as the probes measure.
      G -= 0.9 * shared;
    }
    G.diagonal().array() = G.diagonal().array().max(0.0) + 1.0;
    const Eigen::LLT<MatrixXd> solved(G);
    if (solved.info() != Eigen::Success || !b.allFinite()) return 0.0;
    return b.head(m).dot(solved.solve(b));
  }

 private:
  Index place_;
  std::vector<Index> in_;  // rows of products
  Eigen::LLT<MatrixXd> H_;
  double least_ = 0.0;
};

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
Column WavesOf(const ParameterScan& sweep, const Block& block) {
  Column column;
  const CandidateRegressor trial = sweep.make(sweep.value(0));
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

/// The best of a block beside one model.
class BestOfBlock {
 public:
  bool MayTake(double gain) const {
    return best.size() < kOfBlock || gain > best.back().gain;
  }
  void Take(double gain, Variation one) {
    if (!MayTake(gain)) return;
    best.push_back({gain, std::move(one)});
    std::ranges::sort(best, std::greater<>(), &Promise::gain);
    if (best.size() > kOfBlock) best.pop_back();
  }
  std::vector<Promise> best;
};

/// What blocks promise beside the models behind one noise.
class PromisesBehind {
 public:
  PromisesBehind(const WhitenedModels& of, std::size_t blocks)
      : of_(of),
        products_(of.map, of.W, of.models),
        promises_(blocks, std::vector<BestOfBlock>(of.models.size())) {
    for (std::size_t i = 0; i < of.models.size(); ++i) {
      beside_.emplace_back(of.models[i], static_cast<Index>(i), products_, of.sd);
    }
  }

  void Ask(std::size_t block, const Variation& one) {
    const MatrixXd of_one = products_.Of(one);
    for (std::size_t i = 0; i < beside_.size(); ++i) {
      const double gain = beside_[i].Gain(of_one);
      BestOfBlock& best = promises_[block][i];
      if (best.MayTake(gain)) best.Take(gain, one);
    }
  }

  /// Of every period or frequency at once: the sine and the cosine times u.
  /// @param of_shape  the wave of a step of the sweep
  void AskWaves(std::size_t block, const ParameterScan& sweep, const Column& waves,
                const VectorXd& sd, const std::pair<double, double>& bounds,
                const std::function<Variation(Index)>& of_shape) {
    Eigen::MatrixXcd sums(sweep.count, products_.u.cols());
    for (Index j = 0; j < sums.cols(); ++j) {
      sums.col(j) =
          WaveSums(products_.transposed[static_cast<std::size_t>(j)].Along(waves),
                   sweep.angle, sweep.increment, sweep.count);
    }
    const auto count = std::ssize(beside_);
    MatrixXd all_gains = MatrixXd::Zero(sweep.count, count);
    for (Index m = 0; m < sweep.count; ++m) {
      const double value = sweep.value(m);
      if (value < bounds.first || value > bounds.second) continue;
      MatrixXd of_wave(sums.cols(), 2);
      of_wave.col(0) = sd[0] * sums.row(m).imag().transpose();
      of_wave.col(1) = sd[1] * sums.row(m).real().transpose();
      for (Index i = 0; i < count; ++i) {
        all_gains(m, i) = beside_[static_cast<std::size_t>(i)].Gain(of_wave);
      }
    }
    for (Index i = 0; i < count; ++i) {
      BestOfBlock& best = promises_[block][static_cast<std::size_t>(i)];
      const auto gains = all_gains.col(i);
      for (Index m = 0; m < gains.size(); ++m) {
        const double before = m > 0 ? gains[m - 1] : 0.0;
        const double after = m + 1 < gains.size() ? gains[m + 1] : 0.0;
        if (gains[m] <= before || gains[m] < after) continue;
        if (best.MayTake(gains[m])) best.Take(gains[m], of_shape(m));
      }
    }
  }

  /// The most promising join those that are kept already.
  void KeepIn(const std::vector<Block>& blocks, std::vector<Variation>& kept) {
    for (std::size_t i = 0; i < beside_.size(); ++i) {
      std::map<std::string, std::size_t> of_group;
      std::size_t in_place = 0;
      for (Promise& one : Sorted(i, blocks)) {
        const std::string& group = blocks[one.variation.block].group;
        if (!group.empty() && ++of_group[group] > kOfGroup) continue;
        if (i > 0 && ++in_place > kInPlace) break;
        const bool is_known = std::ranges::any_of(kept, [&](const Variation& other) {
          return other.block == one.variation.block &&
                 other.shape == one.variation.shape;
        });
        if (!is_known) kept.push_back(std::move(one.variation));
      }
    }
  }

 private:
  /// Beside one model.
  std::vector<Promise> Sorted(std::size_t model, const std::vector<Block>& blocks) {
    std::vector<Promise> all;
    for (std::size_t place = 0; place < promises_.size(); ++place) {
      std::vector<Promise>& of_block = promises_[place][model].best;
      if (model > 0 && of_block.size() > 1) of_block.resize(1);
      const double least = std::max(0.5 * blocks[place].price, beside_[model].least());
      for (Promise& one : of_block) {
        if (one.gain > least && kUncertain * one.gain > of_.least) {
          all.push_back(std::move(one));
        }
      }
    }
    std::ranges::stable_sort(all, std::greater<>(), &Promise::gain);
    return all;
  }

  const WhitenedModels& of_;
  Products products_;
  std::vector<PromiseBeside> beside_;
  std::vector<std::vector<BestOfBlock>> promises_;  // by block and model
};

}  // namespace

std::vector<Variation> PromisingVariations(
    const Machine& machine, const BlockMotion& along,
    const std::vector<WhitenedModels>& behind, std::vector<Block>& blocks,
    const std::function<bool(const Block&)>& may_come) {
  std::vector<PromisesBehind> promises;
  for (const WhitenedModels& one : behind) promises.emplace_back(one, blocks.size());
  ParallelFor(static_cast<int>(blocks.size()), [&](int number) {
    const auto place = static_cast<std::size_t>(number);
    Block& block = blocks[place];
    if (!may_come(block)) return;
    const std::optional<ParameterScan> sweep = ParameterScanOf(machine, along, block);
    if (!sweep) {
      ForEachVariation(machine, along, place, block, [&](Variation&& one) {
        for (PromisesBehind& of_noise : promises) of_noise.Ask(place, one);
      });
      return;
    }
    const BlockScales scales = ScalesOf(machine, along, block);
    const auto of_shape = [&](Index m) {
      return VariationOf(place, block, scales, sweep->make(sweep->value(m)),
                         static_cast<std::size_t>(m));
    };
    const Variation first = of_shape(0);
    block.price = PriceOf(block, sweep->count);
    if (first.columns.empty()) return;
    const Column waves = WavesOf(*sweep, block);
    for (PromisesBehind& of_noise : promises) {
      of_noise.AskWaves(place, *sweep, waves, first.sd, BoundsOf(block), of_shape);
    }
  });
  std::vector<Variation> kept;
  for (PromisesBehind& one : promises) one.KeepIn(blocks, kept);
  return kept;
}

}  // namespace mjdiag
