#include "mjdiag/discovery/regression/set_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <random>
#include <utility>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/regression/fold_gram.h"
#include "mjdiag/discovery/regression/whitening.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
// A set has to promise that much more, in -2 ln: odds of 20.
constexpr double kLeastGain = 6.0;
constexpr int kFolds = 40;
// White noises that measure how large a column is: to a quarter of it.
constexpr Index kProbes = 32;

/// Smaller and smaller latent forces.
std::vector<FilterNoise> NoisesFrom(const FilterNoise& found) {
  std::vector<FilterNoise> noises;
  for (const double part : {1.0, 0.4, 0.15, 0.05, 0.01, 1e-6}) {
    noises.push_back(found);
    noises.back().size *= part;
    noises.back().white *= part;
  }
  return noises;
}

/// Places of the variations of a set among those that are whitened.
using Places = std::vector<std::size_t>;

Places Without(Places set, std::size_t member) {
  set.erase(set.begin() + static_cast<std::ptrdiff_t>(member));
  return set;
}

class Choice {
 public:
  Choice(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
         const std::vector<Candidate>& candidates, const ChoiceOptions& options)
      : machine_(machine),
        options_(options),
        along_{MotionAlong(machine, run, path), path.noise.reading,
               run.Time().maxCoeff()},
        blocks_(BlocksOf(machine, candidates)),
        noises_(NoisesFrom(path.noise)) {
    const MatrixXd inflation = InflationAlong(path);
    whitenings_.resize(noises_.size());
    ParallelFor(static_cast<int>(noises_.size()), [&](int number) {
      const auto r = static_cast<std::size_t>(number);
      whitenings_[r] = std::make_unique<Whitening>(path, noises_[r], inflation);
    });
  }

  ChosenSet Run();

 private:
  struct Scored {
    double score = kImpossible;
    std::size_t noise = 0;
    SetFit fit;
  };
  void Screen();
  void Whiten();
  Scored ScoreOf(const Places& set) const;
  double PriceOf(const Places& set) const;
  bool Grow();
  void Exchange();
  std::vector<Index> ColumnsOf(const Places& set) const;
  bool IsWithinBounds(const Places& set, const VectorXd& amplitudes) const;
  std::string Describe() const;

  const Machine& machine_;
  const ChoiceOptions& options_;
  BlockMotion along_;
  std::vector<Block> blocks_;
  std::vector<FilterNoise> noises_;
  std::vector<std::unique_ptr<Whitening>> whitenings_;
  std::vector<Variation> kept_;  // those of the set first
  std::vector<Index> first_column_;
  std::vector<FoldGram> grams_;
  Places set_;
  Scored scored_;
};

std::vector<Index> Choice::ColumnsOf(const Places& set) const {
  std::vector<Index> columns;
  for (const std::size_t v : set) {
    for (Index i = 0; i < kept_[v].sd.size(); ++i) {
      columns.push_back(first_column_[v] + i);
    }
  }
  return columns;
}

double Choice::PriceOf(const Places& set) const {
  double price = 0.0;
  for (const std::size_t v : set) price += blocks_[kept_[v].block].price;
  return price;
}

bool Choice::IsWithinBounds(const Places& set, const VectorXd& amplitudes) const {
  Index first = 0;
  for (const std::size_t v : set) {
    const Variation& one = kept_[v];
    const VectorXd a = amplitudes.segment(first, one.sd.size());
    first += one.sd.size();
    if (one.least.size() > 0 && (a.array() < one.least.array()).any()) return false;
    if (!one.values(a)) return false;
  }
  return true;
}

Choice::Scored Choice::ScoreOf(const Places& set) const {
  Scored best;
  const std::vector<Index> columns = ColumnsOf(set);
  VectorXd sd(std::ssize(columns));
  Index next = 0;
  for (const std::size_t v : set) {
    sd.segment(next, kept_[v].sd.size()) = kept_[v].sd;
    next += kept_[v].sd.size();
  }
  const double price = PriceOf(set);
  for (std::size_t r = 0; r < grams_.size(); ++r) {
    SetFit fit = FitSet(grams_[r], columns, sd);
    const double score =
        fit.unseen + price + fit.amplitudes.cwiseQuotient(sd).squaredNorm();
    if (!(score < best.score)) continue;
    best = {score, r, std::move(fit)};
  }
  if (!set.empty() && !IsWithinBounds(set, best.fit.amplitudes))
    best.score = kImpossible;
  return best;
}

/// The most promising variations of every block beside the set, which stays in front.
void Choice::Screen() {
  const Whitening& whitening = *whitenings_[scored_.noise];
  std::vector<Variation> set;
  for (const std::size_t v : set_) set.push_back(kept_[v]);
  std::vector<const Column*> columns;
  VectorXd sd(0);
  for (const Variation& one : set) {
    for (const Column& column : one.columns) columns.push_back(&column);
    sd.conservativeResize(sd.size() + one.sd.size());
    sd.tail(one.sd.size()) = one.sd;
  }
  const MatrixXd W = whitening.Of(columns);
  const Index k = W.cols();
  MatrixXd u(W.rows(), 1 + k + kProbes);
  u.col(0) = whitening.left();
  if (k > 0) u.col(0) -= W * scored_.fit.amplitudes;
  u.middleCols(1, k) = W;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (Index j = 1 + k; j < u.cols(); ++j) {
    for (Index i = 0; i < u.rows(); ++i) u(i, j) = normal(generator);
  }
  const auto transposed = whitening.TransposedTimes(u);
  Eigen::LLT<MatrixXd> H;
  if (k > 0) {
    MatrixXd G = W.transpose() * W;
    G.diagonal() += sd.cwiseAbs2().cwiseInverse();
    H.compute(G);
  }
  struct Promise {
    double gain = 0.0;
    Variation variation;
  };
  constexpr std::size_t kOfBlock = 4;
  std::vector<std::vector<Promise>> promises(blocks_.size());
  ParallelFor(static_cast<int>(blocks_.size()), [&](int number) {
    const auto place = static_cast<std::size_t>(number);
    std::vector<Promise>& best = promises[place];
    ForEachVariation(machine_, along_, place, blocks_[place], [&](Variation&& one) {
      const bool chosen = std::ranges::any_of(set, [&](const Variation& other) {
        return other.block == one.block && other.shape == one.shape;
      });
      if (chosen) return;
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
      if (solved.info() != Eigen::Success || !b.allFinite()) return;
      const double gain = b.dot(solved.solve(b));
      if (best.size() == kOfBlock && gain <= best.back().gain) return;
      best.push_back({gain, std::move(one)});
      std::ranges::sort(best, std::greater<>(), &Promise::gain);
      if (best.size() > kOfBlock) best.pop_back();
    });
  });
  kept_ = std::move(set);
  for (std::size_t i = 0; i < set_.size(); ++i) set_[i] = i;
  for (std::size_t place = 0; place < promises.size(); ++place) {
    for (Promise& one : promises[place]) {
      if (one.gain > 0.3 * blocks_[place].price) {
        kept_.push_back(std::move(one.variation));
      }
    }
  }
}

void Choice::Whiten() {
  std::vector<const Column*> columns;
  first_column_.clear();
  for (const Variation& one : kept_) {
    first_column_.push_back(std::ssize(columns));
    for (const Column& column : one.columns) columns.push_back(&column);
  }
  grams_.clear();
  for (const auto& whitening : whitenings_) {
    grams_.push_back(GramOf(*whitening, columns, kFolds));
  }
}

/// One or two members more; false if none pays.
bool Choice::Grow() {
  constexpr std::size_t kBeam = 12;
  struct Grown {
    Places set;
    double score = kImpossible;
  };
  const auto grow = [&](const std::vector<Places>& from) {
    std::vector<Grown> grown;
    for (const Places& set : from) {
      for (std::size_t v = 0; v < kept_.size(); ++v) {
        if (std::ranges::find(set, v) != set.end()) continue;
        grown.push_back({set, 0.0});
        grown.back().set.push_back(v);
      }
    }
    ParallelFor(static_cast<int>(grown.size()), [&](int i) {
      Grown& one = grown[static_cast<std::size_t>(i)];
      one.score = ScoreOf(one.set).score;
    });
    std::ranges::sort(grown, {}, &Grown::score);
    return grown;
  };
  std::vector<Grown> one = grow({set_});
  std::vector<Places> beam;
  for (std::size_t i = 0; i < std::min(kBeam, one.size()); ++i) {
    beam.push_back(one[i].set);
  }
  const std::vector<Grown> two = grow(beam);
  const Grown* best = nullptr;
  if (!one.empty()) best = &one.front();
  if (!two.empty() && two.front().score < best->score - kLeastGain) best = &two.front();
  if (best == nullptr || best->score > scored_.score - kLeastGain) return false;
  set_ = best->set;
  scored_ = ScoreOf(set_);
  return true;
}

void Choice::Exchange() {
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t i = 0; i < set_.size() && !moved; ++i) {
      const Places without = Without(set_, i);
      const Scored scored = ScoreOf(without);
      if (scored.score > scored_.score) continue;
      set_ = without;
      scored_ = scored;
      moved = true;
    }
    for (std::size_t i = 0; i < set_.size() && !moved; ++i) {
      std::vector<double> scores(kept_.size(), kImpossible);
      ParallelFor(static_cast<int>(kept_.size()), [&](int number) {
        const auto v = static_cast<std::size_t>(number);
        if (std::ranges::find(set_, v) != set_.end()) return;
        Places other = set_;
        other[i] = v;
        scores[v] = ScoreOf(other).score;
      });
      const auto best = std::ranges::min_element(scores);
      if (*best > scored_.score - 1.0) continue;
      set_[i] = static_cast<std::size_t>(best - scores.begin());
      scored_ = ScoreOf(set_);
      moved = true;
    }
  }
}

std::string Choice::Describe() const {
  std::string text = "score " + std::to_string(scored_.score) + ", noise " +
                     std::to_string(scored_.noise) + ":";
  Index first = 0;
  for (const std::size_t v : set_) {
    const Variation& one = kept_[v];
    const VectorXd a = scored_.fit.amplitudes.segment(first, one.sd.size());
    first += one.sd.size();
    text += " " + blocks_[one.block].name + "(";
    const TrialValues values = one.values(a);
    for (Index i = 0; values && i < values->size(); ++i) {
      text += (i == 0 ? "" : ", ") + std::to_string((*values)[i]);
    }
    text += ")";
  }
  return text;
}

ChosenSet Choice::Run() {
  Whiten();
  scored_ = ScoreOf({});
  ChosenSet chosen;
  chosen.score_of_nothing = scored_.score;
  if (options_.progress) options_.progress("nothing: " + Describe());
  while (static_cast<int>(set_.size()) < options_.most) {
    Screen();
    Whiten();
    scored_ = ScoreOf(set_);
    const double before = scored_.score;
    if (!Grow()) break;
    Exchange();
    if (options_.progress) {
      options_.progress(std::to_string(kept_.size()) + " variations, " + Describe());
    }
    if (scored_.score > before - kLeastGain) break;
  }
  chosen.score = scored_.score;
  chosen.noise = noises_[scored_.noise];
  Index first = 0;
  for (std::size_t i = 0; i < set_.size(); ++i) {
    const Variation& one = kept_[set_[i]];
    chosen.members.push_back({one, scored_.fit.amplitudes.segment(first, one.sd.size()),
                              scored_.fit.sd.segment(first, one.sd.size()),
                              ScoreOf(Without(set_, i)).score - scored_.score});
    first += one.sd.size();
  }
  chosen.blocks = blocks_;
  return chosen;
}

}  // namespace

ChosenSet ChooseSet(const Machine& machine, const MeasuredRun& run,
                    const FilterPath& path, const std::vector<Candidate>& candidates,
                    const ChoiceOptions& options) {
  return Choice(machine, run, path, candidates, options).Run();
}

}  // namespace mjdiag
