#include "mjdiag/discovery/regression/promising.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>

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

}  // namespace

std::vector<Variation> PromisingVariations(const Machine& machine,
                                           const BlockMotion& along,
                                           const Whitening& whitening,
                                           const VectorXd& left, const MatrixXd& W,
                                           const VectorXd& sd,
                                           std::vector<Block>& blocks) {
  const Index k = W.cols();
  MatrixXd u(W.rows(), 1 + k + kProbes);
  u << left, W, WhiteNoise(W.rows(), kProbes);
  const auto transposed = whitening.TransposedTimes(u);
  Eigen::LLT<MatrixXd> H;
  if (k > 0) {
    MatrixXd G = W.transpose() * W;
    G.diagonal() += sd.cwiseAbs2().cwiseInverse();
    H.compute(G);
  }
  /// How much the columns of one take away of what the model leaves, in -2 ln.
  const auto gain_of = [&](const Variation& one) {
    const Index m = one.sd.size();
    MatrixXd products(u.cols(), m);
    for (Index a = 0; a < m; ++a) {
      for (Index j = 0; j < u.cols(); ++j) {
        products(j, a) = one.sd[a] * transposed[static_cast<std::size_t>(j)].Times(
                                         one.columns[static_cast<std::size_t>(a)]);
      }
    }
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
    return b.dot(solved.solve(b));
  };
  struct Promise {
    double gain = 0.0;
    Variation variation;
  };
  std::vector<std::vector<Promise>> promises(blocks.size());
  ParallelFor(static_cast<int>(blocks.size()), [&](int number) {
    const auto place = static_cast<std::size_t>(number);
    std::vector<Promise>& best = promises[place];
    ForEachVariation(machine, along, place, blocks[place], [&](Variation&& one) {
      const double gain = gain_of(one);
      if (best.size() == kOfBlock && gain <= best.back().gain) return;
      best.push_back({gain, std::move(one)});
      std::ranges::sort(best, std::greater<>(), &Promise::gain);
      if (best.size() > kOfBlock) best.pop_back();
    });
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
